"""The table "legibility" of tests/accuracy/run: the words of a poster that was scanned from a metre away, read from the image that the
exported glTF file gives of it. Needs python3-numpy, python3-pil and tesseract-ocr."""
import importlib.util
import io
import json
import os
import re
import shutil
import struct
import subprocess
import sys

POSTER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../core/synthetic/room_letters.h")
SEQUENCE = "synthetic:frames=150,scene=poster"
SEEDS = (1, 2, 3)
# The image is the first frame's view, which looks straight at the poster, at four times its resolution: readers want capitals of twenty pixels.
WIDTH, HEIGHT, FOCAL = 2560, 1920, 2100


def poster_lines():
    """Words and height of their capitals [mm], as the scene has them."""
    with open(POSTER, encoding="utf-8") as text:
        return [(words.split(), round(1000 * float(height))) for words, height in re.findall(r'\{"([A-Z ]+)", ([0-9.]+)f', text.read())]


def read_glb(path):
    """Positions [m], triangles, texture coordinates and image of each primitive that has a texture."""
    import numpy as np  # pylint: disable=import-outside-toplevel
    from PIL import Image  # pylint: disable=import-outside-toplevel
    with open(path, "rb") as file:
        data = file.read()
    json_bytes = struct.unpack_from("<I", data, 12)[0]
    gltf, binary = json.loads(data[20:20 + json_bytes]), data[28 + json_bytes:]

    def view(index):
        place = gltf["bufferViews"][index]
        return binary[place.get("byteOffset", 0):place.get("byteOffset", 0) + place["byteLength"]]

    def accessor(index):
        about = gltf["accessors"][index]
        kind = {5126: "<f4", 5125: "<u4", 5123: "<u2"}[about["componentType"]]
        values = np.frombuffer(view(about["bufferView"])[about.get("byteOffset", 0):], kind, about["count"] * {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[about["type"]])
        return values.reshape(about["count"], -1)

    for mesh in gltf["meshes"]:
        for primitive in mesh["primitives"]:
            material = gltf["materials"][primitive["material"]]
            texture = gltf["textures"][material["pbrMetallicRoughness"]["baseColorTexture"]["index"]]
            image = Image.open(io.BytesIO(view(gltf["images"][texture["source"]]["bufferView"]))).convert("RGB")
            attributes = primitive["attributes"]
            yield (accessor(attributes["POSITION"]), accessor(primitive["indices"]).reshape(-1, 3), accessor(attributes["TEXCOORD_0"]),
                   np.asarray(image, float))


def between_texels(image, uv):
    import numpy as np  # pylint: disable=import-outside-toplevel
    height, width = image.shape[:2]
    x, y = np.clip(uv[:, 0] * width - 0.5, 0, width - 1.001), np.clip(uv[:, 1] * height - 0.5, 0, height - 1.001)
    left, top = x.astype(int), y.astype(int)
    dx, dy = (x - left)[:, None], (y - top)[:, None]
    return (1 - dy) * ((1 - dx) * image[top, left] + dx * image[top, left + 1]) + dy * ((1 - dx) * image[top + 1, left] + dx * image[top + 1, left + 1])


def rendering_of(path):
    """What the first camera sees of the file: at the origin, looking along -z, y up. White where there is nothing."""
    import numpy as np  # pylint: disable=import-outside-toplevel
    from PIL import Image  # pylint: disable=import-outside-toplevel
    rendering, nearest = np.full((HEIGHT, WIDTH, 3), 255.0), np.full((HEIGHT, WIDTH), 0.0)
    for positions, triangles, coordinates, image in read_glb(path):
        depth = np.maximum(-positions[:, 2], 1e-6)
        pixels = np.stack([FOCAL * positions[:, 0] / depth + (WIDTH - 1) / 2, -FOCAL * positions[:, 1] / depth + (HEIGHT - 1) / 2], 1)
        for corners in triangles[(depth[triangles] > 0.05).all(1)]:
            p, inverse = pixels[corners], 1 / depth[corners]
            low, high = np.maximum(np.ceil(p.min(0)), 0).astype(int), np.minimum(np.floor(p.max(0)), (WIDTH - 1, HEIGHT - 1)).astype(int)
            if (high < low).any():
                continue
            (ax, ay), (bx, by) = p[1] - p[0], p[2] - p[0]
            area = ax * by - ay * bx
            if abs(area) < 1e-9:
                continue
            y, x = np.mgrid[low[1]:high[1] + 1, low[0]:high[0] + 1].reshape(2, -1)
            px, py = x - p[0, 0], y - p[0, 1]
            second, third = (px * by - py * bx) / area, (ax * py - ay * px) / area
            weights = np.stack([1 - second - third, second, third], 1) * inverse
            inside = (weights >= -1e-6).all(1)
            here = weights.sum(1)
            inside &= here > nearest[y, x]
            if not inside.any():
                continue
            x, y, weights, here = x[inside], y[inside], weights[inside], here[inside]
            nearest[y, x] = here
            rendering[y, x] = between_texels(image, weights / here[:, None] @ coordinates[corners])
    return Image.fromarray(np.clip(rendering + 0.5, 0, 255).astype(np.uint8))


def words_read(rendering, path):
    """The image is kept at `path`, to be looked at."""
    rendering.save(path)
    done = subprocess.run(["tesseract", path, "-", "--psm", "6"], capture_output=True, text=True, check=True)
    return re.findall(r"[A-Z]+", done.stdout)


def missing_from(words, read):
    left = list(read)
    missing = []
    for word in words:
        if word in left:
            left.remove(word)
        else:
            missing.append(word)
    return missing


def row_of(source, what, read):
    cells = [source, what]
    for height_mm in sorted({height for _, height in poster_lines()}, reverse=True):
        words = [word for line, height in poster_lines() for word in line if height == height_mm]
        missing = missing_from(words, read)
        cells.append(f"{len(words) - len(missing)}/{len(words)}" + (f" (not {', '.join(missing)})" if missing else ""))
    return cells


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)} ended with {done.returncode}: {done.stderr[-2000:]}")


def first_frame(runner, source, work):
    """The recording's first image at the size of ours: what one frame alone would give."""
    from PIL import Image  # pylint: disable=import-outside-toplevel
    run(runner.hermite, "convert", source, os.path.join(work, "frame"), "--to", "tum", "--frames", "0:1")
    folder = os.path.join(work, "frame", "rgb")
    with Image.open(os.path.join(folder, os.listdir(folder)[0])) as image:
        return image.resize((WIDTH, HEIGHT), Image.BICUBIC)


def legibility_table(runner, work, table):
    """Prints it. `work`: an empty folder."""
    lacking = [name for name, module in (("python3-numpy", "numpy"), ("python3-pil", "PIL")) if importlib.util.find_spec(module) is None]
    lacking += [] if shutil.which("tesseract") else ["tesseract-ocr"]
    if lacking:
        print(f"skipped: legibility needs {', '.join(lacking)}; with Debian's own /usr/bin/python3", file=sys.stderr)
        return
    rows = []
    for seed in SEEDS:
        source, folder = f"{SEQUENCE},noise={runner.noise},seed={seed}", os.path.join(work, f"seed-{seed}")
        os.makedirs(folder)
        if seed == SEEDS[0]:
            rows.append(row_of(source, "its first frame alone", words_read(first_frame(runner, source, folder), os.path.join(folder, "frame.png"))))
        result, glb = os.path.join(folder, "result"), os.path.join(folder, "poster.glb")
        runner.call("reconstruct", source, "--out", result)
        runner.call("mesh", result)
        run(runner.hermite, "export", result, "--format", "glb", "--sequence", source, "--out", glb)
        rows.append(row_of(source, "the textured mesh", words_read(rendering_of(glb), os.path.join(folder, "picture.png"))))
    heights = sorted({height for _, height in poster_lines()}, reverse=True)
    table(["sequence", "read from"] + [f"words with capitals of {height} mm" for height in heights], rows)
