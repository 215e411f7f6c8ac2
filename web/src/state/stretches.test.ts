import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import type { FrameList, FrameStatus } from '../connection/frames';
import { countsOf, doubtsIn, frameAt, stretchesOf, stripOf, unusedShares } from './stretches';

// 10 frames a second, from 100 s on; each letter is a frame, a dash none.
const letters: Record<string, FrameStatus> = {
  t: 'tracked',
  w: 'weak',
  l: 'lost',
  o: 'left_out',
  r: 'refused',
  d: 'damaged',
  u: 'unknown',
};
const listWith = (
  statuses: readonly FrameStatus[],
  timestamps_s: FrameList['timestamps_s'],
): FrameList => ({
  timestamps_s,
  statuses,
  reasons: statuses.map(() => ''),
});
const at30Hz = (statuses: readonly FrameStatus[]): FrameList =>
  listWith(
    statuses,
    statuses.map((_, i) => i / 30),
  );
const listOf = (text: string): FrameList => {
  const there = [...text].flatMap((letter, i) =>
    letter === '-'
      ? []
      : [{ status: letters[letter]!, time_s: letter === 'd' ? null : 100 + i / 10 }],
  );
  return listWith(
    there.map(({ status }) => status),
    there.map(({ time_s }) => time_s),
  );
};
const short = (text: string): string[] =>
  stretchesOf(listOf(text)).map(
    ({ follow, first, last, from_s, to_s }) =>
      `${follow} ${first}-${last} ${from_s.toFixed(1)}-${to_s.toFixed(1)}`,
  );

describe('stretchesOf', () => {
  it('merges neighbours of the same kind', () => {
    expect(short('tttlltt')).toEqual([
      'tracked 0-2 0.0-0.3',
      'lost 3-4 0.3-0.5',
      'tracked 5-6 0.5-0.7',
    ]);
    expect(short('l')).toEqual(['lost 0-0 0.0-0.0']);
    expect(short('')).toEqual([]);
  });

  it('passes over frames that were not used, and says where there are none at all', () => {
    expect(short('tototdtrt')).toEqual(['tracked 0-8 0.0-1.0']);
    expect(short('ttt---------ttt')).toEqual([
      'tracked 0-2 0.0-0.3',
      'gap 2-3 0.3-1.2',
      'tracked 3-5 1.2-1.5',
    ]);
  });
});

describe('doubtsIn', () => {
  const doubts = (text: string) =>
    doubtsIn(stretchesOf(listOf(text))).map(({ first, last, ...doubt }) => doubt);

  it('takes what is close together for one, and the worst of it', () => {
    expect(doubts('ttwttllltwt')).toEqual([
      {
        follow: 'lost',
        from_s: expect.closeTo(0.2),
        to_s: expect.closeTo(1),
        weak: 2,
        lost: 3,
        weak_s: expect.closeTo(0.2),
        lost_s: expect.closeTo(0.3),
        losses: 1,
        middle: 6,
      },
    ]);
    expect(doubts('twttttttttllt')).toMatchObject([
      { follow: 'weak', weak: 1, middle: 1 },
      { follow: 'lost', lost: 2, middle: 10 },
    ]);
    expect(doubts('tttt')).toEqual([]);
  });

  it('does not take the whole of a place for lost because of one frame in it', () => {
    const [doubt, ...others] = doubts(`${'wttt'.repeat(150)}l${'tttw'.repeat(150)}`);
    expect(others).toEqual([]);
    expect(doubt).toMatchObject({
      follow: 'lost',
      weak: 300,
      lost: 1,
      losses: 1,
      weak_s: expect.closeTo(30),
      lost_s: expect.closeTo(0.1),
      middle: 600,
    });
  });

  it('counts how often the camera was lost, and a gap finds nobody', () => {
    expect(doubts('tltltt')).toMatchObject([{ losses: 2, lost: 2, lost_s: expect.closeTo(0.2) }]);
    expect(doubts('ttl-----ltt')).toMatchObject([
      { losses: 1, lost: 2, lost_s: expect.closeTo(0.2) },
    ]);
  });

  it('has a used frame of the worst kind stand for it', () => {
    expect(doubts('tlooolt')).toMatchObject([{ lost: 2, middle: 1 }]);
    expect(doubts('tltlllt')).toMatchObject([{ lost: 4, middle: 4 }]);
    const statuses = Array.from(
      { length: 18_000 },
      (_, i): FrameStatus => (i % 4 < 2 ? 'tracked' : 'weak'),
    );
    expect(doubtsIn(stretchesOf(at30Hz(statuses)))).toMatchObject([
      { weak: 9000, weak_s: expect.closeTo(300), middle: 2 },
    ]); // the first of equals
  });
});

describe('stripOf', () => {
  it('stays small however many frames there are, and hides no lost frame', () => {
    const frames = 18_000;
    const statuses = Array.from(
      { length: frames },
      (_, i): FrameStatus => (i === 9000 ? 'lost' : i % 7 === 0 ? 'weak' : 'tracked'),
    );
    const stretches = stretchesOf(at30Hz(statuses));
    expect(stretches.length).toBeGreaterThan(5000);
    const pieces = stripOf(stretches, 500);
    expect(pieces.length).toBeLessThanOrEqual(500);
    const lost = pieces.filter(({ follow }) => follow === 'lost');
    expect(lost).toHaveLength(1);
    expect(Math.abs((lost[0]!.from + lost[0]!.to) / 2 - 0.5)).toBeLessThan(0.01);
  });

  it('covers all of its length, in order and without holes', () => {
    fc.assert(
      fc.property(
        fc.array(fc.constantFrom(...'twlou-'), { minLength: 2, maxLength: 400 }),
        fc.integer({ min: 3, max: 60 }),
        (text, most) => {
          const pieces = stripOf(stretchesOf(listOf(text.join(''))), most);
          expect(pieces.length).toBeLessThanOrEqual(most);
          if (pieces.length === 0) return;
          expect(pieces[0]!.from).toBe(0);
          expect(pieces.at(-1)!.to).toBeCloseTo(1);
          pieces.slice(1).forEach(({ from }, i) => expect(from).toBeCloseTo(pieces[i]!.to));
        },
      ),
    );
  });
});

describe('of the list of frames', () => {
  it('knows how many were not used, and when', () => {
    expect(unusedShares(listOf('tttt'), 0.4, 2)).toEqual([]);
    const shares = unusedShares(listOf('ttttooto'), 0.8, 2);
    expect(shares).toEqual([0, 0.75]);
    expect(countsOf(listOf('ttoodw').statuses)).toMatchObject({
      tracked: 2,
      left_out: 2,
      damaged: 1,
      weak: 1,
      lost: 0,
    });
  });

  it('finds the frame of a moment', () => {
    const list = listOf('ttdtt');
    expect([0, 0.21, 0.5, 1].map((share) => frameAt(list, 0.5, share))).toEqual([0, 1, 1, 4]);
    expect(frameAt(listOf(''), 0, 0.5)).toBeNull();
  });
});
