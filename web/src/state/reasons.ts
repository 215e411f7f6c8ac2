// Why the camera was lost or doubtful in a stretch of frames, in the words of
// the server. Pure functions.
import type { FrameList } from '../connection/frames';
import type { Doubt } from './stretches';

// What was said most often of those of its frames that make it lost, or doubtful; empty when
// nothing was kept. Reasons that differ in their numbers only count as one, of which that with the
// most frequent numbers stands here.
export function reasonOf(
  { statuses, reasons }: FrameList,
  { follow, first, last }: Pick<Doubt, 'follow' | 'first' | 'last'>,
): string {
  const times = new Map<string, number>();
  for (let frame = first; frame <= last; ++frame) {
    const reason = statuses[frame] === follow ? reasons[frame] : '';
    if (reason) times.set(reason, (times.get(reason) ?? 0) + 1);
  }
  const timesOfKinds = new Map<string, number>();
  for (const [reason, count] of times)
    timesOfKinds.set(kindOf(reason), (timesOfKinds.get(kindOf(reason)) ?? 0) + count);
  const kind = mostOften([...timesOfKinds]);
  return mostOften([...times].filter(([reason]) => kindOf(reason) === kind));
}

const kindOf = (reason: string): string => reason.replace(/\d+/g, '#');

// The first one of those that are as often.
function mostOften(counted: readonly (readonly [string, number])[]): string {
  return [...counted].sort((a, b) => b[1] - a[1])[0]?.[0] ?? '';
}
