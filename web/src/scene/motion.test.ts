import { describe, expect, it } from 'vitest';
import { GlidingPose } from './motion';

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
