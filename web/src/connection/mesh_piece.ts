// Draco bytes of a piece of a live surface -> what the scene draws (core/output/mesh_chunk.h).
import { DracoError } from './draco_instance';
import type { DracoMeshDecoder, WantedAttribute } from './draco_mesh';
import type { MeshPiece } from './events';

const wanted: readonly WantedAttribute[] = [
  { name: 'position', uniqueId: 0, type: 'Float32Array' },
  { name: 'normal', uniqueId: 1, type: 'Float32Array' },
  { name: 'color', uniqueId: 2, type: 'Uint8Array' },
  { name: 'confidence', uniqueId: 3, type: 'Uint8Array', optional: true },
];

// Rejects with a DracoError with a message.
export async function decodePiece(
  decoder: DracoMeshDecoder,
  draco: Uint8Array,
  declaredTriangles: number,
): Promise<MeshPiece> {
  const { index, attributes } = await decoder.decode(draco, wanted);
  if (index.length !== 3 * declaredTriangles)
    throw new DracoError(`${index.length / 3} triangles decoded, ${declaredTriangles} declared`);
  const [position, normal, color, confidence] = attributes;
  if (attributes.some((attribute) => attribute.itemSize !== (attribute === confidence ? 1 : 3)))
    throw new DracoError('an attribute of a piece of mesh has another number of components');
  const positions_m = position!.array as Float32Array;
  const vertices = positions_m.length / 3;
  const normals = new Int8Array(4 * vertices);
  const colors = new Uint8Array(4 * vertices).fill(255);
  for (let i = 0; i < vertices; ++i) {
    for (let axis = 0; axis < 3; ++axis) {
      if (!Number.isFinite(positions_m[3 * i + axis]!))
        throw new DracoError('a position is not finite');
      normals[4 * i + axis] = Math.round(127 * normal!.array[3 * i + axis]!);
      colors[4 * i + axis] = color!.array[3 * i + axis]!;
    }
    if (confidence) colors[4 * i + 3] = confidence.array[i]!;
  }
  return {
    triangles: declaredTriangles,
    index,
    positions_m,
    normals,
    colors,
    hasConfidences: confidence !== undefined,
  };
}
