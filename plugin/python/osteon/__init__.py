"""Osteon's cutting engine: bone that gives way to reamers, drills and burrs, for haptics and studies.

A thin layer over libosteon (osteon.h) by ctypes and numpy. Units are SI unless a name says otherwise (_mm).
Frames: everything is in the bone's frame G, right-handed; the tool's frame T has its origin at the apex and +z
along the feed. A pose is a 4 x 4 matrix X_GT; a wrench is an array of 6, force [N] then torque [N m] at T's
origin, in G.

    import osteon
    session = osteon.Session(osteon.Bone(), osteon.Tool(), lockstep=True)
    for ms in range(5000):
        X_GT = session.bone.approach(-0.017 - 0.002e-3 * ms)
        session.step(X_GT, session.tool.spindle_rad_per_s, 0.001)
        F = session.evaluate(X_GT)
    session.export_surface("bone.stl")

Errors are osteon.Error, with the library's text. The library is looked for in $OSTEON_LIBRARY, beside the
installation that this file belongs to, then by the system.
"""

import ctypes as c
import sys

try:
    import numpy as np
except ModuleNotFoundError as error:
    if error.name != "numpy":
        raise
    raise ModuleNotFoundError(
        f"osteon: found no numpy for {sys.executable}; accepted: a Python that has it. Debian's /usr/bin/python3 has it"
        " after `apt install python3-numpy`, another Python after `python3 -m pip install numpy`",
        name="numpy") from None

from ._library import (
    Error, VERTEX, _ABI, _Assessment, _BoneInfo, _BoneParams, _Buffers, _Chunk, _ComplianceParams, _Deflection,
    _Event, _Figures, _GuidanceOutput, _GuidanceParams, _LogCallback, _PlanInfo, _PlanParams, _Pose, _Reamer,
    _ScoreItem, _Settings, _SurfaceInfo, _ToolParams, _Wrench, _check, _lib,
)
from ._values import (
    _balls, _fields_of, _from_pose, _set, _six, _text, _to_pose, _twist, _wrench,
)

__all__ = ["Bone", "Error", "Guidance", "Plan", "Session", "Tool", "VERTEX", "version"]


def version():
    """The library's version, such as "1.0.0"."""
    return _lib.osteon_version().decode()


class Bone:
    """A bone, from one of: a scene's name or file, a mesh file with its site, a packing file, balls.

    scene      "acetabulum" (default), "molar", …; for a mesh, the scene whose tissues it gets
    mesh       STL, OBJ or PLY; mesh_scale_mm millimetres a unit; needs site
    packing    .osp file of `osteon pack`
    balls_mm   (n, 4) array of x y z r [mm]; material is their tissue's name
    site       (center_m (3), axis (3), radius_m) where it is cut
    """

    def __init__(self, scene=None, *, mesh=None, mesh_scale_mm=1.0, packing=None, balls_mm=None, material=None,
                 site=None, config_folder=None):
        params = _BoneParams()
        _check(_lib.osteon_bone_params_init(_ABI, c.byref(params)))
        params.scene, params.mesh_file, params.packing_file = _text(scene), _text(mesh), _text(packing)
        params.mesh_scale_mm = mesh_scale_mm
        params.material = _text(material)
        params.config_folder = _text(config_folder)
        if balls_mm is not None:
            balls = _balls(balls_mm)
            params.balls_mm, params.ball_count = balls.ctypes.data_as(c.POINTER(c.c_float)), len(balls)
        if site is not None:
            params.site_center_m[:], params.site_axis[:], params.site_radius_m = list(site[0]), list(site[1]), site[2]
        self._handle = c.c_void_p()
        _check(_lib.osteon_bone_create(_ABI, c.byref(params), c.byref(self._handle)))

    def __del__(self):
        if getattr(self, "_handle", None):
            _lib.osteon_bone_destroy(self._handle)

    @property
    def info(self):
        """dict: balls, mass_points, volume_m3, mass_kg, site_center_m, site_axis, site_radius_m, materials (their names),
        colors ((n, 3) uint8, red green blue of each material, for the `material` of VERTEX)."""
        info = _BoneInfo()
        _check(_lib.osteon_bone_info(self._handle, c.byref(info)))
        result = {name: getattr(info, name) for name, _ in _BoneInfo._fields_ if name != "material_count"}
        for name in ("site_center_m", "site_axis"):
            result[name] = np.array(result[name])
        result["materials"] = [
            _lib.osteon_bone_material(self._handle, i).decode() for i in range(info.material_count)
        ]
        colors = np.zeros((info.material_count, 3), np.uint8)
        for i, color in enumerate(colors):
            _check(_lib.osteon_bone_material_color(self._handle, i, color.ctypes.data_as(c.POINTER(c.c_uint8))))
        result["colors"] = colors
        return result

    @property
    def warning(self):
        """str: what was assumed to make a solid of a mesh that bounds none, such as an open one; "": nothing."""
        return _lib.osteon_bone_warning(self._handle).decode()

    def approach(self, height_m):
        """X_GT (4, 4) [m] of a tool that points into the site, its apex height_m above the site's centre (-1 … 1)."""
        pose = _Pose()
        _check(_lib.osteon_bone_approach(self._handle, height_m, c.byref(pose)))
        return _from_pose(pose)


class Tool:
    """A tool: a shipped one by name and diameter, or balls in T, (n, 4) of x y z r [mm].

    cutting    (n,) of bool for balls: which of them cut; None: all
    """

    def __init__(self, name=None, diameter_m=0.0, *, balls_mm=None, cutting=None, config_folder=None):
        if diameter_m > 0.5:
            raise ValueError(f"Tool: found a diameter of {diameter_m:g} m, accepted metres, such as 0.05")
        params = _ToolParams()
        _check(_lib.osteon_tool_params_init(_ABI, c.byref(params)))
        params.name, params.diameter_m, params.config_folder = _text(name), diameter_m, _text(config_folder)
        if balls_mm is not None:
            balls = _balls(balls_mm)
            params.balls_mm, params.ball_count = balls.ctypes.data_as(c.POINTER(c.c_float)), len(balls)
            if cutting is not None:
                flags = np.ascontiguousarray(cutting, np.uint8)
                if flags.shape != (len(balls),):
                    raise ValueError(f"cutting: found shape {flags.shape}, accepted ({len(balls)},)")
                params.cutting = flags.ctypes.data_as(c.POINTER(c.c_uint8))
        self._handle = c.c_void_p()
        _check(_lib.osteon_tool_create(_ABI, c.byref(params), c.byref(self._handle)))

    def __del__(self):
        if getattr(self, "_handle", None):
            _lib.osteon_tool_destroy(self._handle)

    @property
    def spindle_rad_per_s(self):
        """float: the tool's usual spindle speed [rad/s], for step() and set_tool_pose(); 0.0 for a tool of balls."""
        return _lib.osteon_tool_spindle_rad_per_s(self._handle)


class Plan:
    """A surgical plan: where the cup goes, with which reamers, how the hand is guided, and what scores.

    plan       name of a shipped plan, or its YAML file; None: "acetabulum"
    rubric     name of a shipped rubric, or its YAML file; None: by the plan's kind
    """

    def __init__(self, plan=None, rubric=None, *, config_folder=None):
        params = _PlanParams()
        _check(_lib.osteon_plan_params_init(_ABI, c.byref(params)))
        params.plan, params.rubric, params.config_folder = _text(plan), _text(rubric), _text(config_folder)
        self._handle = c.c_void_p()
        _check(_lib.osteon_plan_create(_ABI, c.byref(params), c.byref(self._handle)))

    def __del__(self):
        if getattr(self, "_handle", None):
            _lib.osteon_plan_destroy(self._handle)

    @property
    def info(self):
        """dict: cup_center_m, cup_axis (unit, out of the opening), cup_diameter_m, native_center_m, radiographic, operative
        and anatomic (each inclination_rad, anteversion_rad), reamer_count, is_left, has_guidance."""
        info = _PlanInfo()
        _check(_lib.osteon_plan_info(self._handle, c.byref(info)))
        result = _fields_of(info)
        for name in ("radiographic", "operative", "anatomic"):
            result[name] = _fields_of(result[name])
        for name in ("is_left", "has_guidance"):
            result[name] = bool(result[name])
        return result

    @property
    def reamers(self):
        """list of dict: diameter_m, center_m (of the head) and apex_m (T's origin) where it is planned to end."""
        reamers = []
        for index in range(self.info["reamer_count"]):
            reamer = _Reamer()
            _check(_lib.osteon_plan_reamer(self._handle, index, c.byref(reamer)))
            reamers.append(_fields_of(reamer))
        return reamers


class Guidance:
    """The guidance that holds a hand to a plan with one of its reamers: a funnel, a cone of tilt and a depth.

    reamer     index in the plan's sequence
    gain       0 … 1; None: the plan's own
    limits     max_force_N (at most 200), max_torque_Nm (at most 20), max_speed_m_per_s, period_s between two evaluate()
    """

    def __init__(self, plan, reamer=0, *, gain=None, **limits):
        params = _GuidanceParams()
        _check(_lib.osteon_guidance_params_init(_ABI, c.byref(params)))
        params.reamer, params.gain = reamer, -1.0 if gain is None else gain
        _set("Guidance", params, limits, ("max_force_N", "max_torque_Nm", "max_speed_m_per_s", "period_s"))
        self._handle = c.c_void_p()
        _check(_lib.osteon_guidance_create(_ABI, plan._handle, c.byref(params), c.byref(self._handle)))

    def __del__(self):
        if getattr(self, "_handle", None):
            _lib.osteon_guidance_destroy(self._handle)

    def evaluate(self, X_GT, twist=None, other=None):
        """dict at this pose, once in each period: wrench (6,), cone_rad, lateral_m and depth_m (how far outside; <= 0:
        inside), share, potential_J, energy_J, inside, stop_spindle, jumped. twist (6,) as for Session.evaluate();
        other (6,): the wrench that is rendered in addition; at the limits it takes precedence."""
        output, beside = _GuidanceOutput(), _six("other", other, _Wrench)
        _check(_lib.osteon_guidance_evaluate(
            self._handle, c.byref(_to_pose(X_GT)), _twist(twist), beside, c.byref(output)))
        result = _fields_of(output)
        result["wrench"] = _wrench(output.wrench)
        for name in ("inside", "stop_spindle", "jumped"):
            result[name] = bool(result[name])
        return result

    def set_gain(self, gain):
        """Sets the gain, 0 … 1."""
        _check(_lib.osteon_guidance_set_gain(self._handle, gain))

    def set_model_age(self, age_s):
        """Age of the contact model that `other` is made of: from 20 ms on the guidance fades, from 60 ms on there is
        none."""
        _check(_lib.osteon_guidance_set_model_age(self._handle, age_s))

    def reset(self):
        """Begins anew, after a change of tool or a jump of the pose."""
        _check(_lib.osteon_guidance_reset(self._handle))


class Session:
    """A bone that is cut by a tool.

    lockstep   True: step() computes the frames, the same in every run. False: the session's own thread does, at its
               own rate, with the poses of set_tool_pose()
    engine     "auto", "cpu" or "vulkan"; device: part of a GPU's name
    surface    whether the carved surface is made
    limits     max_force_N (at most 200), max_torque_Nm (at most 20), stiffness_N_per_m, damping_Ns_per_m
    """

    def __init__(self, bone, tool, *, lockstep=False, engine="auto", device=None, surface=True, **limits):
        settings = _Settings()
        _check(_lib.osteon_settings_init(_ABI, c.byref(settings)))
        engines = ["auto", "cpu", "vulkan"]
        if engine not in engines:
            raise ValueError(f"engine: found {engine!r}, accepted one of {engines}")
        settings.engine, settings.device = engines.index(engine), _text(device)
        settings.lockstep, settings.surface = int(lockstep), int(surface)
        _set("Session", settings, limits, ("max_force_N", "max_torque_Nm", "stiffness_N_per_m", "damping_Ns_per_m"))
        self.bone, self.tool = bone, tool
        self._generation = c.c_uint64(0)
        self._handle = c.c_void_p()
        _check(_lib.osteon_session_create(_ABI, bone._handle, tool._handle, c.byref(settings), c.byref(self._handle)))

    def __del__(self):
        self.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        """Ends the session and its threads. Safe to call twice."""
        if getattr(self, "_handle", None):
            _lib.osteon_session_destroy(self._handle)
            self._handle = None

    @property
    def engine(self):
        """str: what computes the frames, such as "cpu on one thread, AVX-512 (…)"."""
        return _lib.osteon_session_engine(self._handle).decode()

    def set_log(self, callback):
        """Sets the function callback(level, text) that receives the session's messages; None: no function does.

        level is "info", "warning" or "error". The session's own thread calls it, too; it must call no method of this
        session.
        """
        levels = ["info", "warning", "error"]
        told = _LogCallback() if callback is None else _LogCallback(
            lambda _, level, text: callback(levels[level], text.decode()))
        _check(_lib.osteon_session_set_log(self._handle, told, None))
        self._log = told  # alive as long as it may be called

    def set_tool_pose(self, X_GT, spindle_rad_per_s=0.0):
        """Sets the tool's pose X_GT (4, 4) [m] and its spindle's speed [rad/s]. The first pose must be free of bone."""
        _check(_lib.osteon_session_set_tool_pose(self._handle, c.byref(_to_pose(X_GT)), spindle_rad_per_s))

    def step(self, X_GT, spindle_rad_per_s=0.0, dt_s=0.001):
        """Lockstep: computes a frame at X_GT (4, 4) [m] with the spindle's speed [rad/s], dt_s [s] (0 … 0.1) later."""
        _check(_lib.osteon_session_step(self._handle, c.byref(_to_pose(X_GT)), spindle_rad_per_s, dt_s))

    def evaluate(self, X_GT, twist=None):
        """The coupling wrench (6,) at this pose; twist (6,): linear [m/s], angular [rad/s] of T, in G."""
        wrench = _Wrench()
        _check(_lib.osteon_session_evaluate(self._handle, c.byref(_to_pose(X_GT)), _twist(twist), c.byref(wrench)))
        return _wrench(wrench)

    def set_compliance(self, *, tool=False, layer=False, mount=None, **figures):
        """Chooses the parts that give way from now on, starting at rest; without arguments none does. Each evaluate()
        moves them on.

        tool      True: the tool bends as its file says
        layer     True: soft tissue yields as the bone's materials say
        mount     True, or a dict of its figures: point_m (3), mass_kg, inertia_kg_m2 (3), stiffness_N_per_m (3),
                  stiffness_Nm_per_rad (3), damping_ratio, creep_N_per_m, creep_s
        figures   period_s between two evaluate(), push_N (greatest thrust), noticed_m
        """
        params = _ComplianceParams()
        _check(_lib.osteon_compliance_params_init(_ABI, c.byref(params)))
        params.tool, params.layer, params.mount = int(bool(tool)), int(bool(layer)), int(bool(mount))
        if isinstance(mount, dict):
            params.mount = 1
            figures = {**figures, **{"mount_" + name: value for name, value in mount.items()}}
        _set("set_compliance", params, figures, [name for name, _ in _ComplianceParams._fields_[4:]])
        _check(_lib.osteon_session_set_compliance(_ABI, self._handle, c.byref(params)))

    @property
    def deflection(self):
        """dict after the newest evaluate(): head (X_ME, the bent tool in the bone), bone (X_GM, where to draw the bone),
        bend_m, bend_rad, layer_m, mount_m, mount_rad, mount_m_per_s, mount_rad_per_s, and bool gives_way, noticed,
        beyond_limit (the caller should stop)."""
        deflection = _Deflection()
        _check(_lib.osteon_session_deflection(self._handle, c.byref(deflection)))
        result = _fields_of(deflection)
        result["head"], result["bone"] = _from_pose(deflection.head), _from_pose(deflection.bone)
        for name in ("gives_way", "noticed", "beyond_limit"):
            result[name] = bool(result[name])
        return result

    @property
    def figures(self):
        """dict of the newest frame: frame, proxy (X_GP; NaN before the first frame), wrench (6,), removed_volume_m3,
        depth_m, …"""
        figures = _Figures()
        _check(_lib.osteon_session_figures(self._handle, c.byref(figures)))
        result = {name: getattr(figures, name) for name, _ in _Figures._fields_ if name != "reserved"}
        result["proxy"], result["wrench"] = _from_pose(figures.proxy), _wrench(figures.wrench)
        return result

    def events(self):
        """Events that have not been taken: (name, value_m, position_m, frame)."""
        event, taken = _Event(), []
        while _check(_lib.osteon_session_next_event(self._handle, c.byref(event))) == 0:
            taken.append((event.name.decode(), event.value_m, np.array(event.position_m), event.frame))
        return taken

    def change_tool(self, tool, X_GT):
        """Another tool from now on, at X_GT (4, 4) [m], free of bone: else Error, and nothing changes."""
        _check(_lib.osteon_session_change_tool(self._handle, tool._handle, c.byref(_to_pose(X_GT))))
        self.tool = tool

    def mark(self):
        """Remembers the bone as it is, for undo()."""
        _check(_lib.osteon_session_mark(self._handle))

    def undo(self, X_GT):
        """Returns to the last mark; X_GT (4, 4) [m] must be free of the bone that comes back."""
        _check(_lib.osteon_session_undo(self._handle, c.byref(_to_pose(X_GT))))

    def save(self, file):
        """Saves the carved bone as `file` and, with a surface, `file`.swept. Each appears whole or not at all."""
        _check(_lib.osteon_session_save(self._handle, _text(file)))

    def restore(self, file, X_GT):
        """Returns to a bone that save() wrote, of the same Bone; any tool.

        X_GT       (4, 4) where the tool is [m]: free of the bone that comes back, else Error, and nothing changes
        """
        _check(_lib.osteon_session_restore(self._handle, _text(file), c.byref(_to_pose(X_GT))))

    def assess(self, plan):
        """Compares the reamed bone with a plan for it: dict of score, axis_error_rad, diameter_m, center_m, coverage,
        removed_m3, over_m3, under_m3, … (NaN: not measured), and items, a list of dict: metric, unit, value, full,
        zero, weight, points."""
        found, count, items = _Assessment(), c.c_size_t(), (_ScoreItem * 64)()
        _check(_lib.osteon_session_assess(
            self._handle, plan._handle, c.byref(found), items, len(items), c.byref(count)))
        result = _fields_of(found)
        result["items"] = [_fields_of(item) for item in items[: count.value]]
        for item in result["items"]:
            item["metric"], item["unit"] = item["metric"].decode(), item["unit"].decode()
        return result

    def surface_changes(self):
        """Bricks of the surface that changed since the last call: a list of (brick, vertices, triangles), vertices of
        dtype VERTEX, triangles (n, 3) of uint16, counter-clockwise from outside. Empty arrays: the brick has gone."""
        chunks, changed = (_Chunk * 256)(), []
        vertices, indices = np.empty(256 * 1024, VERTEX), np.empty(1024 * 1024, np.uint16)
        buffers = _Buffers(chunks, vertices.ctypes.data, indices.ctypes.data, len(chunks), len(vertices), len(indices))
        while True:
            _check(_lib.osteon_session_surface_changes(self._handle, c.byref(self._generation), c.byref(buffers)))
            for chunk in chunks[: buffers.chunk_count]:
                changed.append((
                    chunk.brick,
                    vertices[chunk.first_vertex : chunk.first_vertex + chunk.vertex_count].copy(),
                    indices[chunk.first_index : chunk.first_index + chunk.index_count].reshape(-1, 3).copy(),
                ))
            if buffers.left == 0:
                return changed

    def wait_for_surface(self):
        """Waits until all frames so far are in the surface: seconds after the start of a large mesh, else some ms."""
        _check(_lib.osteon_session_surface_wait(self._handle))

    def export_surface(self, file):
        """Writes the carved bone (.stl, .ply, .obj) in mm: dict of triangles, volume_m3, watertight."""
        info = _SurfaceInfo()
        _check(_lib.osteon_session_surface_export(self._handle, _text(file), c.byref(info)))
        return {"triangles": info.triangles, "volume_m3": info.volume_m3, "watertight": bool(info.watertight)}
