// Which way is up in a scan: as somebody has said by a click on the floor, which this browser
// remembers, or as it is found.
import type { ScanScene } from '../scene/scene';
import { ofThisBrowser } from '../state/storages';
import { storedUp, storeUp } from '../state/up_choice';
import { t } from '../texts/texts';
import type { Panel } from './dom';
import { floorPicker } from './floor_picker';
import type { MenuItem } from './menu';

export interface FloorChoice extends Panel {
  actions(): MenuItem[];
}

export function floorChoice(
  canvas: HTMLCanvasElement,
  scene: ScanScene,
  scanId: string,
): FloorChoice {
  const picker = floorPicker(canvas, (x_px, y_px) => {
    const up = scene.floorAt(x_px, y_px);
    if (up) storeUp(ofThisBrowser, scanId, up);
    return up !== null;
  });
  const findAgain = (): void => {
    storeUp(ofThisBrowser, scanId, null);
    scene.setUp(null);
  };
  scene.setUp(storedUp(ofThisBrowser, scanId));
  return {
    element: picker.element,
    actions() {
      const isChosen = storedUp(ofThisBrowser, scanId) !== null;
      return [
        { label: t.setTheFloor, do: picker.begin },
        ...(isChosen ? [{ label: t.findTheFloorAgain, do: findAgain }] : []),
      ];
    },
    dispose: picker.dispose,
  };
}
