// Does something again every few seconds while the page is seen.

export interface WhileSeen {
  again(): Promise<void>; // at once
  dispose(): void;
}

// `work` says whether it is to be done again; if not, it waits for `again` or until
// the page is looked at anew.
export function whileSeen(every_ms: number, work: () => Promise<boolean>): WhileSeen {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let disposed = false;
  const again = async (): Promise<void> => {
    clearTimeout(timer);
    const goesOn = document.visibilityState !== 'visible' || (await work());
    if (goesOn && !disposed) timer = setTimeout(() => void again(), every_ms);
  };
  const onVisible = (): void => void again();
  document.addEventListener('visibilitychange', onVisible);
  return {
    again,
    dispose() {
      disposed = true;
      clearTimeout(timer);
      document.removeEventListener('visibilitychange', onVisible);
    },
  };
}
