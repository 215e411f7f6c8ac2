// What the panel of the view offers for what is shown of a scan just now.
import { hasEnded, type LiveScan } from './live_scan';
import { asksForSurface, shownMeshColor, type MeshColor, type ViewOptions } from './view_options';

export interface ViewOffer {
  readonly show: boolean; // the choice between surface and points
  readonly surface: boolean; // its colours
  readonly points: boolean; // their colours
  readonly pointLooks: boolean; // their size and their edges
  readonly meshColor: MeshColor; // that the surface has
  readonly coverage: boolean;
  readonly coverageInMenu: boolean; // on a phone
  readonly unfoldable: boolean; // on a phone, while the model needs the room
  readonly follow: boolean;
}

// `isTextured`: the finished surface that is seen, also while another one is
// made; null: there is none.
export function viewOffer(
  options: ViewOptions,
  scan: LiveScan,
  isTextured: boolean | null,
): ViewOffer {
  const { phase, triangles, surfaceHasConfidences, framesReceived } = scan;
  const there = isTextured !== null;
  const onSurface =
    (there || triangles > 0) && asksForSurface(options, !there && surfaceHasConfidences === true);
  const isOnPointsOnly = options.coverage && (there || surfaceHasConfidences === false);
  const running = phase === 'running';
  return {
    show: !isOnPointsOnly && (there || triangles > 0 || running),
    surface: onSurface && !options.coverage,
    points: !onSurface && !options.coverage,
    pointLooks: !onSurface,
    meshColor: shownMeshColor(options, isTextured ?? false),
    coverage: framesReceived > 0,
    coverageInMenu: !running && !options.coverage,
    unfoldable: running,
    follow: !hasEnded(phase), // afterwards nobody leads any more
  };
}
