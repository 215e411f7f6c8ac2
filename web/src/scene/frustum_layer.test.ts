import { Sprite } from 'three';
import { describe, expect, it } from 'vitest';
import { FrustumLayer, frustumLines } from './frustum_layer';
import type { ScanEvent } from '../connection/events';
import { frame, poses, running } from './played';

const camera = { width: 4, height: 2, fx: 2, fy: 2, cx: 1.5, cy: 0.5 };

function points(lines: Float32Array): [number, number, number][] {
  return Array.from({ length: lines.length / 3 }, (_, i) => [
    lines[3 * i]!,
    lines[3 * i + 1]!,
    lines[3 * i + 2]!,
  ]);
}

describe('frustumLines', () => {
  it('spans the outer borders of the corner pixels', () => {
    const corners = points(frustumLines(camera, 1)).slice(0, 16);
    expect(Math.min(...corners.map((p) => p[0]))).toBeCloseTo(-1);
    expect(Math.max(...corners.map((p) => p[0]))).toBeCloseTo(1);
    expect(Math.min(...corners.map((p) => p[1]))).toBeCloseTo(-0.5);
    expect(Math.max(...corners.map((p) => p[1]))).toBeCloseTo(0.5);
  });

  it.each([2, -2])('has its roof on the upper side (fy %d)', (fy) => {
    const roof = points(frustumLines({ ...camera, fy }, 1)).slice(16);
    for (const point of roof) expect(point[1]).toBeLessThan(-0.4); // y points down
  });
});

// A layer whose text is only kept.
function silent(): { layer: FrustumLayer; said: () => string } {
  let text = '';
  const layer = new FrustumLayer({
    object: new Sprite(),
    say: (label) => (text = label),
    resize: () => {},
    dispose: () => {},
  });
  layer.onEvent({ kind: 'welcome', title: '', camera });
  return { layer, said: () => text };
}

describe('FrustumLayer', () => {
  it('shows the last good view in another colour while the camera is lost, with a text', () => {
    const { layer, said } = silent();
    layer.onEvent(frame(0, 1));
    const tracked = layer.object.material.color.getHex();
    expect(said()).toBe('');
    layer.onEvent(
      frame(0, 1, {
        tracking: 'lost',
        timestamp_s: 4,
        lastTracked: { sequence: 0, timestamp_s: 0 },
      }),
    );
    expect(layer.object.material.color.getHex()).not.toBe(tracked);
    expect(said()).toBe('Go back to this view, seen 4 s ago');
    expect(layer.worldFromCamera.translation.x).toBe(1);
    layer.onEvent(frame(0, 1));
    expect(said()).toBe('');
  });

  it('asks nobody to go anywhere once the scan has ended', () => {
    const { layer, said } = silent();
    layer.onEvent(running);
    layer.onEvent(frame(0, 1));
    layer.onEvent(
      frame(0, 1, {
        tracking: 'lost',
        timestamp_s: 4,
        lastTracked: { sequence: 0, timestamp_s: 0 },
      }),
    );
    expect(layer.object.visible).toBe(true);
    layer.onEvent({ ...running, phase: 'finished' } as ScanEvent);
    expect(layer.object.visible).toBe(false);
    expect(said()).toBe('');
    layer.onEvent(
      frame(0, 1, {
        tracking: 'lost',
        timestamp_s: 4,
        lastTracked: { sequence: 0, timestamp_s: 0 },
      }),
    ); // the newest, of who comes later
    expect(said()).toBe('');
    expect(layer.object.visible).toBe(false);
  });

  it('moves with the submap of its frame when that is corrected', () => {
    const { layer } = silent();
    layer.onEvent(frame(1, 2));
    layer.onEvent(poses([5]));
    layer.tick(1000);
    expect(layer.worldFromCamera.translation.x).toBe(2); // another submap
    layer.onEvent(poses([5, 10]));
    layer.tick(1000);
    expect(layer.worldFromCamera.translation.x).toBe(12);
  });

  it('stays hidden until something was tracked', () => {
    const { layer } = silent();
    layer.onEvent(frame(0, 0, { tracking: 'lost', lastTracked: null }));
    expect(layer.object.visible).toBe(false);
    layer.onEvent(frame(0, 0));
    expect(layer.object.visible).toBe(true);
  });
});
