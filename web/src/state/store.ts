// A value, the one way to change it, and whoever wants to know.

export interface Store<State, Event> {
  get(): State;
  dispatch(event: Event): void;
  // Calls `listener` at once and after every change. Returns how to stop.
  subscribe(listener: (state: State) => void): () => void;
}

export function createStore<State, Event>(
  initial: State,
  reduce: (state: State, event: Event) => State,
): Store<State, Event> {
  let state = initial;
  const listeners = new Set<(state: State) => void>();
  return {
    get: () => state,
    dispatch(event) {
      const next = reduce(state, event);
      if (next === state) return;
      state = next;
      for (const listener of [...listeners]) listener(state);
    },
    subscribe(listener) {
      listeners.add(listener);
      listener(state);
      return () => listeners.delete(listener);
    },
  };
}
