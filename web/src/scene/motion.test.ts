import { describe, expect, it } from 'vitest';
import { composed, GlidingPose } from './motion';

const at = (x: number) => ({ translation: [x, 0, 0] as const, rotation: [0, 0, 0, 1] as const });

describe('GlidingPose', () => {
  it('stands at its first pose at once and glides to the next ones', () => {
    const pose = new GlidingPose(100);
    expect(pose.known).toBe(false);
    pose.moveTo(at(1));
    expect(pose.translation.x).toBe(1);
    pose.moveTo(at(2));
    expect(pose.tick(50)).toBe(true);
    expect(pose.translation.x).toBeCloseTo(1.5);
    expect(pose.tick(500)).toBe(true);
    expect(pose.translation.x).toBe(2);
    expect(pose.tick(50)).toBe(false);
  });

  it('is not held up by being told the same goal again', () => {
    const pose = new GlidingPose(100);
    pose.moveTo(at(1));
    pose.moveTo(at(2));
    pose.tick(50);
    pose.moveTo(at(2));
    pose.tick(50);
    expect(pose.translation.x).toBe(2);
    pose.moveTo(at(2));
    expect(pose.tick(50)).toBe(false);
  });

  it('turns to a new goal from where it is', () => {
    const pose = new GlidingPose(100);
    pose.moveTo(at(0));
    pose.moveTo(at(1));
    pose.tick(50);
    pose.moveTo(at(0));
    expect(pose.translation.x).toBeCloseTo(0.5);
    pose.tick(50);
    expect(pose.translation.x).toBeCloseTo(0.25);
  });
});

describe('composed', () => {
  it('turns before it moves', () => {
    const quarter = {
      translation: [0, 0, 5],
      rotation: [0, 0, Math.SQRT1_2, Math.SQRT1_2],
    } as const; // x becomes y
    const pose = composed(quarter, at(2));
    expect(pose.translation[0]).toBeCloseTo(0);
    expect(pose.translation[1]).toBeCloseTo(2);
    expect(pose.translation[2]).toBe(5);
    expect(pose.rotation).toEqual(quarter.rotation);
  });
});
