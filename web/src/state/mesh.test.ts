import { describe, expect, it } from 'vitest';
import { asItIs, type ScanExport } from '../connection/exports';
import { initialLiveScan, reduceLiveScan, type LiveScan } from './live_scan';
import { isMeshSettled, mayHaveMesh, meshText, nextStep } from './mesh';

const mesh = (change: Partial<ScanExport>): ScanExport => ({
  format: 'glb-draco',
  of_format: 'glb-draco',
  finish: asItIs,
  kind: 'mesh',
  label: 'Mesh',
  file: 'mesh.draco.glb',
  state: 'missing',
  size_bytes: 0,
  done: 0,
  words: '',
  ...change,
});

describe('mayHaveMesh', () => {
  const whole: LiveScan = {
    ...initialLiveScan('a'),
    phase: 'finished',
    snapshotComplete: true,
    points: 1000,
  };
  it('is of scans that have ended with points, when these are there', () => {
    expect(mayHaveMesh(whole)).toBe(true);
    expect(mayHaveMesh({ ...whole, phase: 'interrupted' })).toBe(true);
    expect(mayHaveMesh({ ...whole, phase: 'running' })).toBe(false);
    expect(mayHaveMesh({ ...whole, phase: 'failed' })).toBe(false);
    expect(mayHaveMesh({ ...whole, points: 0 })).toBe(false);
    expect(mayHaveMesh({ ...whole, snapshotComplete: false })).toBe(false);
  });

  it('is waited for only where one may come', () => {
    expect(isMeshSettled(whole)).toBe(false);
    expect(isMeshSettled({ ...whole, mesh: { state: 'loading', done: 0.5 } })).toBe(false);
    expect(
      isMeshSettled({ ...whole, mesh: { state: 'shown', triangles: 1, textured: false } }),
    ).toBe(true);
    expect(isMeshSettled({ ...whole, mesh: { state: 'failed', message: 'too large' } })).toBe(true);
    expect(isMeshSettled({ ...whole, points: 0 })).toBe(true);
    expect(isMeshSettled({ ...whole, points: 0, snapshotComplete: false })).toBe(false);
    expect(isMeshSettled({ ...whole, phase: 'failed' })).toBe(true);
  });
});

describe('nextStep', () => {
  it('asks once for what nobody has made, and for what has failed before', () => {
    expect(nextStep(mesh({ state: 'missing' }), false)).toEqual({ step: 'ask' });
    expect(nextStep(mesh({ state: 'failed', words: 'too large' }), false)).toEqual({ step: 'ask' });
    expect(nextStep(mesh({ state: 'failed', words: 'too large' }), true)).toEqual({
      step: 'giveUp',
      message: 'too large',
    });
    expect(nextStep(mesh({ state: 'missing' }), true).step).toBe('giveUp');
  });
  it('waits while it is made and loads it then', () => {
    expect(nextStep(mesh({ state: 'queued', words: 'the disk is full' }), true)).toEqual({
      step: 'wait',
      done: 0,
      message: 'the disk is full',
    });
    expect(nextStep(mesh({ state: 'running', done: 0.4 }), false)).toEqual({
      step: 'wait',
      done: 0.4,
      message: '',
    });
    expect(nextStep(mesh({ state: 'ready', size_bytes: 7 }), false)).toEqual({
      step: 'load',
      size_bytes: 7,
    });
  });
  it('gives up with a server that knows no meshes', () => {
    expect(nextStep(undefined, false).step).toBe('giveUp');
  });
});

describe('meshText', () => {
  it('says what is waited for, and why there is nothing', () => {
    expect(meshText({ state: 'making', done: 0.456, message: '' }, true)).toContain('45 %');
    expect(meshText({ state: 'making', done: 0, message: 'the disk is full' }, true)).toBe(
      'The surface waits: the disk is full.',
    );
    expect(meshText({ state: 'failed', message: 'too few points' }, true)).toContain(
      'too few points',
    );
  });
  it('is quiet when the surface is there, or nobody wants it', () => {
    expect(meshText({ state: 'shown', triangles: 1, textured: false }, true)).toBe('');
    expect(meshText({ state: 'failed', message: 'x' }, false)).toBe('');
    expect(meshText({ state: 'none' }, true)).toBe('');
  });
});

describe('the state of a scan', () => {
  it('keeps what there is of its surface', () => {
    const state = reduceLiveScan(initialLiveScan('a'), {
      kind: 'mesh',
      mesh: { state: 'loading', done: 0.5 },
    });
    expect(state.mesh).toEqual({ state: 'loading', done: 0.5 });
  });
});
