// Asks the server once more where that may help.
import { ApiError } from './api';

const most_tries = 5;
const pause_ms = 3_000;

// Throws the error of the last try, at once where another one would not help
// or nobody waits any more.
export async function patiently<Answer>(
  ask: () => Promise<Answer>,
  signal: AbortSignal,
  wait: (ms: number) => Promise<unknown> = pause,
): Promise<Answer> {
  for (let tried = 1; ; ++tried) {
    try {
      return await ask();
    } catch (error) {
      if (signal.aborted || tried === most_tries || !(error instanceof ApiError && error.passing))
        throw error;
    }
    await wait(pause_ms);
  }
}

// Null: the server has no such thing. Other errors stay errors: they say
// nothing of whether it is there.
export async function orMissing<Answer>(answer: Promise<Answer>): Promise<Answer | null> {
  try {
    return await answer;
  } catch (error) {
    if (error instanceof ApiError && error.missing) return null;
    throw error;
  }
}

const pause = (ms: number): Promise<unknown> => new Promise((resolve) => setTimeout(resolve, ms));
