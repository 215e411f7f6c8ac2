import { describe, expect, it } from 'vitest';
import type { FrameEvent, MapEventName, TrackingName } from '../connection/events';
import { listedScan } from '../connection/listed_scan';
import { parseReport } from '../connection/scans';
import { initialLiveScan, reduceLiveScan, type LiveScan, type LiveScanEvent } from './live_scan';
import {
  connectionText,
  emptyText,
  eventText,
  leftOutText,
  partsText,
  pointsText,
  positionText,
  trackingText,
  wayBackCaption,
  wayBackLabel,
} from './text';

const after = (...events: LiveScanEvent[]): LiveScan =>
  events.reduce(reduceLiveScan, initialLiveScan('scan1'));

const frame = (tracking: TrackingName, x: number): FrameEvent => ({
  kind: 'frame',
  sequence: 0,
  timestamp_s: 0,
  worldFromCamera: { translation: [x, 0, 0], rotation: [0, 0, 0, 1] },
  tracking,
  reason: tracking === 'tracked' ? '' : 'few points fit',
  inlierRatio: 1,
  residual_m: 0,
  surfelCount: 5,
  frame_ms: 10,
  inSubmap: null,
  event: 'none',
  correction_m: 0,
  lastTracked: null,
  positionSigma_m: 0.004,
});

const happened = (event: MapEventName, correction_m: number, timestamp_s: number): FrameEvent => ({
  ...frame('tracked', 0),
  event,
  correction_m,
  timestamp_s,
});

const welcome: LiveScanEvent = { kind: 'welcome', title: 'Room', camera: null };
const running = {
  kind: 'scanState',
  phase: 'running',
  words: '',
  received: 2,
  processed: 1,
  dropped: 0,
  keyframes: 0,
  loops: 0,
  paused: false,
  canPause: true,
  up: null,
} as const satisfies LiveScanEvent;

describe('reduceLiveScan', () => {
  it('has the tags and the beginning that the list has, also after a new connection', () => {
    const as = { ...listedScan('scan1', new Date(0)), tags: ['attic', 'house 9'] };
    const state = after(
      welcome,
      { kind: 'listed', as },
      { kind: 'connecting', attempt: 1 },
      welcome,
    );
    expect(state).toMatchObject({
      title: 'Room',
      tags: ['attic', 'house 9'],
      started: new Date(0),
    });
    const without = reduceLiveScan(state, { kind: 'listed', as: { ...as, tags: [] } });
    expect(without.tags).toEqual([]);
  });

  it('counts the poses before and since the viewer came, afresh after reconnecting', () => {
    const past: LiveScanEvent = {
      kind: 'trajectory',
      positions_m: new Float32Array(9),
      submaps: null,
    };
    const seen = after(welcome, past, frame('tracked', 1));
    expect(seen.poses).toBe(4);
    expect(reduceLiveScan(seen, welcome).poses).toBe(0);
  });

  it('says how well the position is known while the scan runs, if the server tells', () => {
    const at = (positionSigma_m: number | null): LiveScan =>
      after(welcome, running, { ...frame('tracked', 1), positionSigma_m });
    expect(positionText(at(0.004))).toBe('± 8 mm');
    expect(positionText(at(0.0001))).toBe('± 1 mm');
    expect(positionText(at(0.0111))).toBe('± 3 cm');
    expect(positionText(at(null))).toBeNull();
    expect(positionText({ ...at(0.004), phase: 'finished' })).toBeNull();
  });

  it('keeps the last tracked camera position while tracking is lost, and says why', () => {
    const lost = after(welcome, running, frame('tracked', 1), frame('lost', 99));
    expect(lost.cameraPosition_m).toEqual([1, 0, 0]);
    expect(trackingText(lost)).toEqual({ text: 'Lost: few points fit', tone: 'warn' });
    expect(trackingText(reduceLiveScan(lost, frame('tracked', 2))).text).toBe('Tracking');
  });

  it('asks a lost camera to go back to what was seen last', () => {
    const lost: FrameEvent = {
      ...frame('lost', 1),
      timestamp_s: 14.2,
      lastTracked: { sequence: 300, timestamp_s: 10 },
    };
    expect(trackingText(after(welcome, running, lost))).toEqual({
      text: 'Lost: few points fit – go back to what was seen 4 s ago',
      tone: 'bad',
    });
    expect(wayBackLabel(lost)).toBe('Go back to this view, seen 4 s ago');
    expect(wayBackLabel({ ...lost, tracking: 'tracked' })).toBe('');
    expect(wayBackLabel({ ...lost, lastTracked: null })).toBe('');
  });

  it('knows the frame that a lost camera is to go back to, until it is found again', () => {
    const lost: FrameEvent = {
      ...frame('lost', 1),
      sequence: 310,
      timestamp_s: 14.2,
      lastTracked: { sequence: 300, timestamp_s: 10 },
    };
    const seen = after(welcome, running, frame('tracked', 1), lost);
    expect(seen.wayBack).toEqual({ sequence: 300, worldFromCamera: lost.worldFromCamera });
    expect(seen.sequence).toBe(310);
    const later = reduceLiveScan(seen, { ...lost, sequence: 311, timestamp_s: 14.3 });
    expect(later.wayBack).toBe(seen.wayBack);
    expect(wayBackCaption(later)).toBe('Go back here, seen 4 s ago');
    expect(reduceLiveScan(later, frame('tracked', 2)).wayBack).toBeNull();
    // Perhaps it was the way back of a scan that is built again.
    expect(reduceLiveScan(later, welcome).wayBack).toBeNull();
    const neverTracked = { ...lost, lastTracked: null };
    expect(after(welcome, running, neverTracked).wayBack).toBeNull();
  });

  it('says what happened to the map, for a while', () => {
    const closed = after(
      welcome,
      running,
      happened('loopClosed', 0.031, 5),
      happened('none', 0, 6),
    );
    expect(eventText(closed)).toBe('Loop closed: the map was corrected by up to 4 cm.');
    expect(eventText(reduceLiveScan(closed, happened('none', 0, 14)))).toBe('');
    expect(eventText(after(welcome, running, happened('loopClosed', 0.001, 5)))).toBe(
      'Loop closed: the map was right.',
    );
    expect(eventText(after(welcome, running, happened('foundAgain', 0, 5)))).toBe('Found again.');
    expect(eventText(after(welcome, running, happened('joined', 1, 5)))).toBe(
      'Two parts of the map are joined.',
    );
    expect(eventText(after(welcome, running, happened('recalibrated', 0.05, 5)))).toBe(
      'The camera’s calibration was off and is corrected: the map was corrected by up to 5 cm.',
    );
    expect(eventText(after(welcome, running, happened('lost', 0, 5)))).toBe('');
    expect(eventText(reduceLiveScan(closed, welcome))).toBe('');
  });

  it('counts submaps and parts, and says that parts will be joined while the scan runs', () => {
    const pose = { translation: [0, 0, 0], rotation: [0, 0, 0, 1] } as const;
    const poses = [0, 0, 3].map((part, submap) => ({ submap, part, worldFromSubmap: pose }));
    const parted = after(welcome, running, { kind: 'submapPoses', poses });
    expect(parted).toMatchObject({ submaps: 3, parts: 2 });
    expect(partsText(parted)).toBe(
      'The map is in 2 parts: they will be joined when the camera sees both.',
    );
    expect(partsText(reduceLiveScan(parted, { ...running, phase: 'finished' }))).toBe('');
    expect(
      partsText(reduceLiveScan(parted, { kind: 'submapPoses', poses: poses.slice(0, 2) })),
    ).toBe('');
  });

  it('follows a camera that is tracked weakly, and warns', () => {
    const weak = after(welcome, running, frame('tracked', 1), frame('weak', 2));
    expect(weak.cameraPosition_m).toEqual([2, 0, 0]);
    expect(trackingText(weak)).toEqual({ text: 'Weak: few points fit', tone: 'warn' });
  });

  it('keeps what it shows while it reconnects', () => {
    const cut = after(
      welcome,
      { kind: 'content', points: 7, chunks: 1, triangles: 0, full: false, old: false },
      { kind: 'waiting', retryIn_ms: 4000, reason: 'cut' },
    );
    expect(cut).toMatchObject({ connection: 'waiting', points: 7, title: 'Room' });
    expect(connectionText(cut).text).toBe('Reconnecting in 4 s');
    expect(emptyText(cut)).toBeNull();
  });

  it('takes a complete scan for no problem, a refused token for one', () => {
    expect(
      connectionText(after(welcome, { kind: 'closed', code: 'complete', reason: '' })).text,
    ).toBe('Complete');
    const refused = after({ kind: 'closed', code: 'unauthorized', reason: '' });
    expect(emptyText(refused)).toBe('The server does not accept this access token.');
    expect(connectionText(refused).tone).toBe('bad');
  });

  it('does not call a scan complete whose frames were left out, and says why counts differ', () => {
    const dropped: LiveScanEvent = {
      ...running,
      phase: 'finished',
      received: 160,
      processed: 68,
      dropped: 92,
    };
    const scan = after(
      welcome,
      dropped,
      { kind: 'content', points: 1200, chunks: 1, triangles: 0, full: false, old: false },
      { kind: 'closed', code: 'complete', reason: '' },
    );
    expect(connectionText(scan)).toEqual({ text: 'Complete, with frames left out', tone: 'warn' });
    expect(leftOutText(scan)).toContain('92 of 160 frames');
    expect(leftOutText(after(welcome, { ...dropped, phase: 'running' }))).toBe('');
    expect(pointsText(scan)).toBe('Shown are 1,200 points, one for every 5 mm.');
    const told = reduceLiveScan(scan, {
      kind: 'report',
      report: parseReport({ surfels: 3000, cloud_points: 2000 }),
    });
    expect(pointsText(told)).toContain(
      'The cloud to download has all 2,000. The map has 3,000 surfels',
    );
    expect(pointsText(after())).toBe('');
  });

  it('forgets an error once the server welcomes it again', () => {
    const error: LiveScanEvent = { kind: 'serverError', code: 'busy', message: 'too many viewers' };
    expect(after(error).problem?.message).toBe('too many viewers');
    expect(after(error, welcome).problem).toBeNull();
  });

  it('learns from the pieces of the surface whether they say how well they were seen', () => {
    const piece = (hasConfidences: boolean | null): LiveScanEvent => ({
      kind: 'meshChunk',
      cube: { part: 0, x: 0, y: 0, z: 0 },
      version: 1n,
      submap: 0,
      piece: hasConfidences === null ? null : { ...nothing, hasConfidences },
    });
    const nothing = {
      triangles: 0,
      index: new Uint32Array(),
      positions_m: new Float32Array(),
      normals: new Int8Array(),
      colors: new Uint8Array(),
    };
    expect(after(welcome, piece(null)).surfaceHasConfidences).toBeNull();
    expect(after(welcome, piece(false)).surfaceHasConfidences).toBe(false);
    const known = after(welcome, piece(true), piece(null));
    expect(known.surfaceHasConfidences).toBe(true);
    expect(reduceLiveScan(known, piece(true))).toBe(known);
  });

  it('has a text for every empty view', () => {
    expect(emptyText(after())).toBe('Loading the scan.');
    expect(emptyText(after(welcome, running, { kind: 'snapshotEnd' }))).toContain('first points');
    expect(
      emptyText(
        after(
          welcome,
          running,
          { kind: 'snapshotEnd' },
          { kind: 'content', points: 0, chunks: 0, triangles: 9, full: false, old: false },
        ),
      ),
    ).toBeNull();
    expect(
      emptyText(after(welcome, { ...running, phase: 'finished' }, { kind: 'snapshotEnd' })),
    ).toBe('This scan has no points.');
    expect(emptyText(after({ kind: 'waiting', retryIn_ms: 1, reason: 'cut' }))).toContain(
      'cannot be reached',
    );
  });
});
