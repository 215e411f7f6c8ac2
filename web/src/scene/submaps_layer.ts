// Where the submaps stand: a correction lets them glide to new poses, and all that
// hangs on them glides along.
import { Group } from 'three';
import type { Pose, ScanEvent } from '../connection/events';
import type { Layer } from './layer';
import { GlidingPose } from './motion';
import { PoseTexture } from './pose_texture';

const correction_ms = 300;

interface Submap {
  readonly group: Group; // of everything that stays in the submap's frame
  readonly worldFromSubmap: GlidingPose;
  part: number;
}

export class SubmapsLayer implements Layer {
  readonly object = new Group();
  readonly poses = new PoseTexture(); // of all of them, for shaders
  version = 0; // another one whenever a submap stands elsewhere than before
  private readonly submaps = new Map<number, Submap>();
  private current: number | null = null; // that the newest frame belongs to
  private running = false;

  onEvent(event: ScanEvent): void {
    if (event.kind === 'submapPoses')
      for (const pose of event.poses) this.move(pose.submap, pose.worldFromSubmap, pose.part);
    if (event.kind === 'frame') this.current = event.inSubmap?.submap ?? null;
    if (event.kind === 'scanState') this.running = event.phase === 'running';
    if (event.kind === 'frame' || event.kind === 'submapPoses' || event.kind === 'scanState')
      this.tellPartsApart();
  }

  tick(elapsed_ms: number): boolean {
    let moving = false;
    for (const [id, submap] of this.submaps) {
      if (!submap.worldFromSubmap.tick(elapsed_ms)) continue;
      this.place(id, submap);
      moving = true;
    }
    return moving;
  }

  // A submap without a pose yet stands where the world begins, as the first one does.
  groupOf(id: number): Group {
    return this.submap(id).group;
  }

  // While a scan runs: not joined yet to the part that the camera is in.
  isApart(id: number): boolean {
    if (!this.running || this.current === null) return false;
    return this.submap(id).part !== this.submap(this.current).part;
  }

  dispose(): void {
    this.poses.dispose();
  }

  private move(id: number, pose: Pose, part: number): void {
    const submap = this.submap(id);
    submap.part = part;
    submap.worldFromSubmap.moveTo(pose);
    this.place(id, submap);
  }

  private place(id: number, submap: Submap): void {
    submap.worldFromSubmap.matrix(submap.group.matrix);
    submap.group.matrixWorldNeedsUpdate = true;
    this.poses.set(id, submap.group.matrix, this.isApart(id));
    ++this.version;
  }

  private tellPartsApart(): void {
    for (const [id, { group }] of this.submaps)
      if (this.poses.isFaded(id) !== this.isApart(id))
        this.poses.set(id, group.matrix, this.isApart(id));
  }

  private submap(id: number): Submap {
    let submap = this.submaps.get(id);
    if (!submap) {
      submap = { group: new Group(), worldFromSubmap: new GlidingPose(correction_ms), part: 0 };
      submap.group.matrixAutoUpdate = false;
      this.submaps.set(id, submap);
      this.object.add(submap.group);
    }
    return submap;
  }
}
