"""Plain writers of depth sets, one a format, from `Shot`s. Nothing of the package is used."""

from __future__ import annotations

import json
import struct

import numpy as np

from tests.io import png_writer

FLIP = np.diag([1.0, -1.0, -1.0, 1.0])


def png(path, samples, bits=8):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(png_writer.encode(samples, bits))


def codes(shot, scale):
    return np.rint(shot.depth / scale).astype(np.uint16)


def integer_k(k):
    """Centres at integers."""
    result = k.copy()
    result[:2, 2] -= 0.5
    return result


def rows(matrix):
    return "\n".join(" ".join(repr(float(x)) for x in row) for row in matrix) + "\n"


def quaternion(r):
    """w, x, y, z of a rotation by less than half a turn."""
    w = np.sqrt(1 + np.trace(r)) / 2
    return np.array([w, *(np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]) / (4 * w))])


def open3d(folder, shots, scale=0.001, depth_scale=None):
    k = integer_k(shots[0].k)
    height, width = shots[0].depth.shape
    tree = {"width": width, "height": height, "intrinsic_matrix": k.T.reshape(-1).tolist()}
    (folder / "camera_intrinsic.json").write_text(
        json.dumps(tree if depth_scale is None else tree | {"depth_scale": depth_scale})
    )
    text = ""
    for i, shot in enumerate(shots):
        png(folder / "color" / f"{i:05d}.png", shot.color)
        png(folder / "depth" / f"{i:05d}.png", codes(shot, scale), 16)
        text += f"{i} {i} {i + 1}\n" + rows(shot.pose)
    (folder / "trajectory.log").write_text(text)
    return folder


def tum(folder, shots, scale=1 / 5000, late=0.005, start=1305031102.0):
    """Pictures ten a second, depth maps a little later, poses a hundred a second, of which only some belong to one."""
    lists = {"rgb": "# color images\n", "depth": "# depth maps\n", "groundtruth": "# ground truth trajectory\n"}
    for i, shot in enumerate(shots):
        time = start + 0.1 * i
        png(folder / "rgb" / f"{time:.6f}.png", shot.color)
        png(folder / "depth" / f"{time + late:.6f}.png", codes(shot, scale), 16)
        lists["rgb"] += f"{time:.6f} rgb/{time:.6f}.png\n"
        lists["depth"] += f"{time + late:.6f} depth/{time + late:.6f}.png\n"
        w, x, y, z = quaternion(shot.rotation)
        for step in (-2, -1, 0, 1, 2):
            shift = shot.center + 0.01 * step
            numbers = [*shift, x, y, z, w]
            lists["groundtruth"] += (
                f"{time + 0.01 * step + 0.001:.4f} " + " ".join(repr(float(n)) for n in numbers) + "\n"
            )
    for name, text in lists.items():
        (folder / f"{name}.txt").write_text(text)
    return folder


def tum_intrinsics(k):
    return (k[0, 0], k[1, 1], k[0, 2] - 0.5, k[1, 2] - 0.5)


def scannet(folder, shots, color_shots=None, scale=0.001):
    """`color_shots`: the same cameras' pictures of another size."""
    for name in ("pose", "intrinsic"):
        (folder / name).mkdir()
    color_shots = color_shots or shots
    for name, of in (("color", color_shots), ("depth", shots)):
        k = np.eye(4)
        k[:3, :3] = integer_k(of[0].k)
        (folder / "intrinsic" / f"intrinsic_{name}.txt").write_text(rows(k))
        (folder / "intrinsic" / f"extrinsic_{name}.txt").write_text(rows(np.eye(4)))
    for i, (shot, color) in enumerate(zip(shots, color_shots, strict=True)):
        png(folder / "color" / f"{i}.png", color.color)
        png(folder / "depth" / f"{i}.png", codes(shot, scale), 16)
        (folder / "pose" / f"{i}.txt").write_text(rows(shot.pose))
    return folder


def transforms(folder, shots, scale=0.001, ngp=True, per_frame=True):
    tree = {"frames": []}
    if ngp:
        tree["integer_depth_scale"] = scale
    for i, shot in enumerate(shots):
        png(folder / "images" / f"{i}.png", shot.color)
        png(folder / "depths" / f"{i}.png", codes(shot, scale), 16)
        height, width = shot.depth.shape
        k = shot.k
        camera = {"fl_x": k[0, 0], "fl_y": k[1, 1], "cx": k[0, 2], "cy": k[1, 2], "w": width, "h": height, "k1": 0.0}
        frame = {"file_path": f"./images/{i}.png", "transform_matrix": (shot.pose @ FLIP).tolist()}
        frame["depth_path" if ngp else "depth_file_path"] = f"depths/{i}.png"
        if per_frame:
            frame |= camera
        else:
            tree |= camera
        tree["frames"].append(frame)
    (folder / "transforms.json").write_text(json.dumps(tree))
    return folder


MODELS = {"SIMPLE_PINHOLE": 0, "PINHOLE": 1, "SIMPLE_RADIAL": 2, "OPENCV": 4}


def colmap(folder, shots, binary=True, place="sparse", model="PINHOLE", bend=0.0, kind="geometric"):
    """A workspace after `image_undistorter` and `patch_match_stereo`."""
    (folder / place).mkdir(parents=True)
    (folder / "stereo" / "depth_maps" / "cam").mkdir(parents=True)
    height, width = shots[0].depth.shape
    cameras, images = [], []
    for i, shot in enumerate(shots):
        r = shot.rotation.T
        f_x, f_y, c_x, c_y = shot.k[0, 0], shot.k[1, 1], shot.k[0, 2], shot.k[1, 2]
        parameters = {"PINHOLE": [f_x, f_y, c_x, c_y], "SIMPLE_RADIAL": [f_x, c_x, c_y, bend],
                      "OPENCV": [f_x, f_y, c_x, c_y, bend, 0.0, 0.0, 0.0]}[model]  # fmt: skip
        cameras.append((i + 1, MODELS[model], width, height, parameters))
        images.append((10 - i, quaternion(r), -r @ shot.center, i + 1, f"cam/{i}.png", i))
        png(folder / "images" / f"cam/{i}.png", shot.color)
        (folder / "stereo" / "depth_maps" / f"cam/{i}.png.{kind}.bin").write_bytes(colmap_map(shot.depth))
    write = _colmap_bin if binary else _colmap_txt
    write(folder / place, cameras, images)
    return folder


def colmap_map(depth):
    height, width = depth.shape
    return f"{width}&{height}&1&".encode() + depth.astype("<f4").tobytes()


def _colmap_bin(folder, cameras, images):
    data = struct.pack("<Q", len(cameras))
    for key, model, width, height, parameters in cameras:
        data += struct.pack(f"<IiQQ{len(parameters)}d", key, model, width, height, *parameters)
    (folder / "cameras.bin").write_bytes(data)
    data = struct.pack("<Q", len(images))
    for key, q, t, camera, name, features in images:
        data += struct.pack("<I7dI", key, *q, *t, camera) + name.encode() + b"\0"
        data += struct.pack("<Q", features) + struct.pack("<ddQ", 1.5, 2.5, 2**64 - 1) * features
    (folder / "images.bin").write_bytes(data)
    (folder / "points3D.bin").write_bytes(struct.pack("<Q", 0))


def _colmap_txt(folder, cameras, images):
    names = {number: name for name, number in MODELS.items()}
    text = "# Camera list\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n"
    for key, model, width, height, parameters in cameras:
        text += f"{key} {names[model]} {width} {height} " + " ".join(repr(float(p)) for p in parameters) + "\n"
    (folder / "cameras.txt").write_text(text)
    text = "# Image list\n"
    for key, q, t, camera, name, features in images:
        text += f"{key} " + " ".join(repr(float(x)) for x in (*q, *t)) + f" {camera} {name}\n"
        text += "1.5 2.5 -1 " * features + "\n"
    (folder / "images.txt").write_text(text)
    (folder / "points3D.txt").write_text("# 3D point list\n")


def pfm(values):
    height, width = values.shape
    return f"Pf\n{width} {height}\n-1\n".encode() + values[::-1].astype("<f4").tobytes()


def middlebury(folder, shots, baseline):
    """Two pictures side by side; disparities are infinite where nothing is."""
    ks = [integer_k(shot.k) for shot in shots]
    height, width = shots[0].depth.shape
    text = "".join(f"cam{i}=[{k[0, 0]} 0 {k[0, 2]}; 0 {k[1, 1]} {k[1, 2]}; 0 0 1]\n" for i, k in enumerate(ks))
    doffs = ks[1][0, 2] - ks[0][0, 2]
    text += f"doffs={doffs}\nbaseline={baseline}\nwidth={width}\nheight={height}\nndisp=60\nisint=0\n"
    (folder / "calib.txt").write_text(text)
    for i, shot in enumerate(shots):
        png(folder / f"im{i}.png", shot.color)
        with np.errstate(divide="ignore"):
            disparity = np.where(shot.valid, baseline * shot.k[0, 0] / shot.depth - doffs, np.inf)
        (folder / f"disp{i}.pfm").write_bytes(pfm(disparity))
    return folder


def own(folder, shots, depth, ending, *, together=False, matrices=None, centers="integer"):
    """A folder of one's own; `depth` writes a map, `matrices` are the poses, else camera to world, OpenCV's axes."""
    k = integer_k(shots[0].k) if centers == "integer" else shots[0].k
    (folder / "intrinsics.txt").write_text(rows(k))
    matrices = [shot.pose for shot in shots] if matrices is None else matrices
    for name in ("depth", "poses"):
        (folder / name).mkdir()
    for i, shot in enumerate(shots):
        png(folder / "color" / f"{i}.png", shot.color)
        depth(folder / "depth" / f"{i}.{ending}", shot)
        if not together:
            (folder / "poses" / f"{i}.txt").write_text(rows(matrices[i]))
    if together:
        (folder / "poses.txt").write_text("".join(rows(matrix) for matrix in matrices))
    return folder
