import { expect, test } from 'vitest';
import { ApiError } from './api';
import { orMissing, patiently } from './patience';

const passing = new ApiError('The server asks to wait a little.', false, true);
const missing = new ApiError('The server does not have this.', false, false, true);
const refused = new ApiError('This access token does not allow that.', true);

// Answers with these, one after the other, for ever with the last one.
function asked(...answers: (ApiError | string)[]) {
  const count = { asked: 0 };
  const ask = async (): Promise<string> => {
    const answer = answers[Math.min(count.asked++, answers.length - 1)]!;
    if (answer instanceof ApiError) throw answer;
    return answer;
  };
  return { ask, count };
}
const now = async (): Promise<void> => {};

test('errors that pass are tried again, a few times', async () => {
  const late = asked(passing, passing, 'here');
  expect(await patiently(late.ask, new AbortController().signal, now)).toBe('here');
  expect(late.count.asked).toBe(3);
  const never = asked(passing);
  await expect(patiently(never.ask, new AbortController().signal, now)).rejects.toBe(passing);
  expect(never.count.asked).toBe(5);
});

test('others are not, and none when nobody waits any more', async () => {
  for (const error of [missing, refused]) {
    const once = asked(error, 'here');
    await expect(patiently(once.ask, new AbortController().signal, now)).rejects.toBe(error);
    expect(once.count.asked).toBe(1);
  }
  await expect(patiently(asked(passing, 'here').ask, AbortSignal.abort(), now)).rejects.toBe(
    passing,
  );
});

test('only what the server does not have is missing', async () => {
  expect(await orMissing(asked('here').ask())).toBe('here');
  expect(await orMissing(asked(missing).ask())).toBeNull();
  for (const error of [passing, refused])
    await expect(orMissing(asked(error).ask())).rejects.toBe(error);
});
