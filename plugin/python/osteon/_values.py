"""Conversions between numpy's arrays and the structs of osteon.h."""

import ctypes as c
import os

import numpy as np

from ._library import _Pose, _Twist, _Wrench


def _text(path):
    """A name or path as bytes for the library; None stays None."""
    if path is None:
        return None
    text = os.fsencode(path)
    if b"\0" in text:
        raise ValueError(f"name: found {path!r}, accepted a text without NUL")
    return text


def _to_pose(X_GT):
    """4 x 4 matrix to position and quaternion (Shepperd's method)."""
    X = np.asarray(X_GT, float)
    if X.shape != (4, 4):
        raise ValueError(f"X_GT: found shape {X.shape}, accepted (4, 4)")
    R = X[:3, :3]
    # the cross product of two columns is the third: neither scaled, nor sheared, nor mirrored
    off = max(np.abs(R @ R.T - np.eye(3)).max(), np.abs(np.cross(R[:, 0], R[:, 1]) - R[:, 2]).max())
    if not off < 1e-3 or tuple(X[3]) != (0.0, 0.0, 0.0, 1.0):
        raise ValueError(f"X_GT: found {X.tolist()}, accepted a rotation and a position [m] in its last column, last row "
                         "0 0 0 1")
    q = np.empty(4)
    # the largest component of the quaternion is the divisor: w, or x, y, z by its index a
    i = int(np.argmax([np.trace(R), R[0, 0], R[1, 1], R[2, 2]]))
    if i == 0:
        q[:] = 1 + np.trace(R), R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    else:
        a = i - 1
        b, d = (a + 1) % 3, (a + 2) % 3
        q[0] = R[d, b] - R[b, d]
        q[1 + a] = 1 + R[a, a] - R[b, b] - R[d, d]
        q[1 + b] = R[a, b] + R[b, a]
        q[1 + d] = R[a, d] + R[d, a]
    return _Pose((c.c_double * 3)(*X[:3, 3]), (c.c_double * 4)(*(q / np.linalg.norm(q))))


def _from_pose(pose):
    """4 x 4 matrix of a pose; NaN for one whose quaternion is zero, before the first frame."""
    length = np.linalg.norm(pose.orientation_wxyz)
    if length == 0:
        return np.full((4, 4), np.nan)
    w, x, y, z = np.array(pose.orientation_wxyz) / length
    X = np.eye(4)
    X[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    X[:3, 3] = pose.position_m
    return X


def _wrench(wrench):
    """Array of 6: force [N], torque [N m]."""
    return np.array([*wrench.force_N, *wrench.torque_Nm])


def _six(name, values, struct):
    """A twist or a wrench for a call, from six numbers; None stays None."""
    if values is None:
        return None
    values = [float(value) for value in values]
    if len(values) != 6:
        raise ValueError(f"{name}: found {len(values)} numbers, accepted 6")
    return c.byref(struct((c.c_double * 3)(*values[:3]), (c.c_double * 3)(*values[3:])))


def _twist(twist):
    return _six("twist", twist, _Twist)


def _fields_of(struct):
    """The fields of a struct as a dict, arrays of numbers as numpy's."""
    result = {}
    for name, kind in struct._fields_:
        value = getattr(struct, name)
        if name != "reserved":
            result[name] = np.array(value) if hasattr(kind, "_length_") and kind._type_ is c.c_double else value
    return result


def _set(who, params, values, known):
    """Sets fields of a struct by name: numbers, or lists of them. Raises TypeError for a name that is not known."""
    for name, value in values.items():
        if name not in known:
            raise TypeError(f"{who}: found {name!r}, accepted {', '.join(known)}")
        if isinstance(getattr(params, name), float):
            setattr(params, name, float(value))
        else:
            getattr(params, name)[:] = [float(each) for each in value]


def _balls(balls_mm):
    """Balls as a contiguous (n, 4) array of float32: x y z r [mm]."""
    balls = np.ascontiguousarray(balls_mm, np.float32)
    if balls.ndim != 2 or balls.shape[1] != 4:
        raise ValueError(f"balls_mm: found shape {balls.shape}, accepted (n, 4): x y z r")
    return balls
