// Whether the images of the camera are to be seen while it scans: what stays chosen, also for other
// scans and after a reload.
const storedAs = 'hermite.live';

export function liveIsWanted(storage: Pick<Storage, 'getItem'>): boolean {
  return storage.getItem(storedAs) !== 'closed';
}

export function storeLive(storage: Pick<Storage, 'setItem'>, wanted: boolean): void {
  try {
    storage.setItem(storedAs, wanted ? 'open' : 'closed');
  } catch {
    // A browser that keeps nothing.
  }
}
