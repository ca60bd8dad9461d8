"""libosteon by ctypes: osteon.h's structs and functions, one to one."""

import ctypes as c
import ctypes.util
import os
from pathlib import Path

import numpy as np

_ABI = 1


class Error(RuntimeError):
    """A refusal of the library. `code` is its OsteonResult; `meaning` says in a few words what the code means."""

    def __init__(self, code, text):
        super().__init__(text)
        self.code = code

    @property
    def meaning(self):
        """str: such as "a file cannot be used"."""
        return _lib.osteon_result_text(self.code).decode()


class _Pose(c.Structure):
    _fields_ = [("position_m", c.c_double * 3), ("orientation_wxyz", c.c_double * 4)]


class _Twist(c.Structure):
    _fields_ = [("linear_m_per_s", c.c_double * 3), ("angular_rad_per_s", c.c_double * 3)]


class _Wrench(c.Structure):
    _fields_ = [("force_N", c.c_double * 3), ("torque_Nm", c.c_double * 3)]


class _BoneParams(c.Structure):
    _fields_ = [
        ("scene", c.c_char_p),
        ("mesh_file", c.c_char_p),
        ("mesh_scale_mm", c.c_double),
        ("packing_file", c.c_char_p),
        ("balls_mm", c.POINTER(c.c_float)),
        ("ball_count", c.c_size_t),
        ("material", c.c_char_p),
        ("site_center_m", c.c_double * 3),
        ("site_axis", c.c_double * 3),
        ("site_radius_m", c.c_double),
        ("config_folder", c.c_char_p),
    ]


class _BoneInfo(c.Structure):
    _fields_ = [
        ("balls", c.c_uint64),
        ("mass_points", c.c_uint64),
        ("volume_m3", c.c_double),
        ("mass_kg", c.c_double),
        ("site_center_m", c.c_double * 3),
        ("site_axis", c.c_double * 3),
        ("site_radius_m", c.c_double),
        ("material_count", c.c_uint32),
    ]


class _ToolParams(c.Structure):
    _fields_ = [
        ("name", c.c_char_p),
        ("diameter_m", c.c_double),
        ("balls_mm", c.POINTER(c.c_float)),
        ("cutting", c.POINTER(c.c_uint8)),
        ("ball_count", c.c_size_t),
        ("config_folder", c.c_char_p),
    ]


class _Settings(c.Structure):
    _fields_ = [
        ("engine", c.c_uint32),
        ("device", c.c_char_p),
        ("lockstep", c.c_uint32),
        ("surface", c.c_uint32),
        ("max_force_N", c.c_double),
        ("max_torque_Nm", c.c_double),
        ("stiffness_N_per_m", c.c_double),
        ("damping_Ns_per_m", c.c_double),
    ]


class _Figures(c.Structure):
    _fields_ = [
        ("frame", c.c_uint64),
        ("pose_age_s", c.c_double),
        ("frame_time_s", c.c_double),
        ("proxy", _Pose),
        ("wrench", _Wrench),
        ("removed_volume_m3", c.c_double),
        ("removed_mass_kg", c.c_double),
        ("cutting_work_J", c.c_double),
        ("spindle_torque_Nm", c.c_double),
        ("engaged_area_m2", c.c_double),
        ("depth_m", c.c_double),
        ("contacts", c.c_uint32),
        ("reserved", c.c_uint32),
        ("skipped_on_surface", c.c_uint64),
    ]


class _Event(c.Structure):
    _fields_ = [("name", c.c_char * 48), ("value_m", c.c_double), ("position_m", c.c_double * 3), ("frame", c.c_uint64)]


class _PlanParams(c.Structure):
    _fields_ = [("plan", c.c_char_p), ("rubric", c.c_char_p), ("config_folder", c.c_char_p)]


class _CupAngles(c.Structure):
    _fields_ = [("inclination_rad", c.c_double), ("anteversion_rad", c.c_double)]


class _PlanInfo(c.Structure):
    _fields_ = [
        ("cup_center_m", c.c_double * 3),
        ("cup_axis", c.c_double * 3),
        ("cup_diameter_m", c.c_double),
        ("native_center_m", c.c_double * 3),
        ("radiographic", _CupAngles),
        ("operative", _CupAngles),
        ("anatomic", _CupAngles),
        ("reamer_count", c.c_uint32),
        ("is_left", c.c_uint32),
        ("has_guidance", c.c_uint32),
        ("reserved", c.c_uint32),
    ]


class _Reamer(c.Structure):
    _fields_ = [("diameter_m", c.c_double), ("center_m", c.c_double * 3), ("apex_m", c.c_double * 3)]


class _GuidanceParams(c.Structure):
    _fields_ = [
        ("reamer", c.c_uint32),
        ("reserved", c.c_uint32),
        ("gain", c.c_double),
        ("max_force_N", c.c_double),
        ("max_torque_Nm", c.c_double),
        ("max_speed_m_per_s", c.c_double),
        ("period_s", c.c_double),
    ]


class _GuidanceOutput(c.Structure):
    _fields_ = [
        ("wrench", _Wrench),
        ("cone_rad", c.c_double),
        ("lateral_m", c.c_double),
        ("depth_m", c.c_double),
        ("share", c.c_double),
        ("potential_J", c.c_double),
        ("energy_J", c.c_double),
        ("inside", c.c_uint32),
        ("stop_spindle", c.c_uint32),
        ("jumped", c.c_uint32),
        ("reserved", c.c_uint32),
    ]


class _Assessment(c.Structure):
    _fields_ = [
        ("score", c.c_double),
        ("axis_error_rad", c.c_double),
        ("diameter_m", c.c_double),
        ("diameter_sd_m", c.c_double),
        ("center_m", c.c_double * 3),
    ] + [(name, c.c_double) for name in (
        "form_p95_m", "medial_m", "superior_m", "posterior_m", "native_medial_m", "native_superior_m",
        "native_posterior_m", "coverage", "removed_m3", "over_m3", "under_m3", "cartilage_left", "rim_preserved",
        "min_wall_m")]


class _ScoreItem(c.Structure):
    _fields_ = [("metric", c.c_char * 32), ("unit", c.c_char * 8)] + [
        (name, c.c_double) for name in ("value", "full", "zero", "weight", "points")]


class _ComplianceParams(c.Structure):
    _fields_ = [(name, c.c_uint32) for name in ("tool", "layer", "mount", "reserved")] + [
        ("period_s", c.c_double),
        ("push_N", c.c_double),
        ("noticed_m", c.c_double),
        ("mount_point_m", c.c_double * 3),
        ("mount_mass_kg", c.c_double),
        ("mount_inertia_kg_m2", c.c_double * 3),
        ("mount_stiffness_N_per_m", c.c_double * 3),
        ("mount_stiffness_Nm_per_rad", c.c_double * 3),
        ("mount_damping_ratio", c.c_double),
        ("mount_creep_N_per_m", c.c_double),
        ("mount_creep_s", c.c_double),
    ]


class _Deflection(c.Structure):
    _fields_ = [("head", _Pose), ("bone", _Pose)] + [(name, c.c_double * 3) for name in (
        "bend_m", "bend_rad", "layer_m", "mount_m", "mount_rad", "mount_m_per_s", "mount_rad_per_s")] + [
        (name, c.c_uint32) for name in ("gives_way", "noticed", "beyond_limit", "reserved")]


class _Chunk(c.Structure):
    _fields_ = [(name, c.c_uint32) for name in
                ("brick", "first_vertex", "vertex_count", "first_index", "index_count", "reserved")]


class _Buffers(c.Structure):
    _fields_ = [
        ("chunks", c.POINTER(_Chunk)),
        ("vertices", c.c_void_p),
        ("indices", c.c_void_p),
        ("chunk_capacity", c.c_size_t),
        ("vertex_capacity", c.c_size_t),
        ("index_capacity", c.c_size_t),
        ("chunk_count", c.c_size_t),
        ("vertex_count", c.c_size_t),
        ("index_count", c.c_size_t),
        ("left", c.c_uint64),
    ]


class _SurfaceInfo(c.Structure):
    _fields_ = [("triangles", c.c_uint64), ("volume_m3", c.c_double), ("watertight", c.c_uint32), ("reserved", c.c_uint32)]


_LogCallback = c.CFUNCTYPE(None, c.c_void_p, c.c_uint32, c.c_char_p)

#: A vertex of the surface: position [mm], unit normal (outward), material, 1 where the tool cut.
VERTEX = np.dtype([("position_mm", "<f4", 3), ("normal", "<f4", 3), ("material", "u1"), ("cut", "u1"), ("reserved", "u1", 2)])


def _load():
    """Opens libosteon: $OSTEON_LIBRARY, else the nearest above this file, else the system's."""
    here = Path(__file__).resolve()
    names = [os.environ.get("OSTEON_LIBRARY")]
    for above in here.parents:
        names += [above / "libosteon.so.0", above / "build/release/plugin/libosteon.so.0"]
        if above.name == "lib":
            names += sorted(above.glob("*/libosteon.so.0"))
    names.append(ctypes.util.find_library("osteon"))
    for name in names:
        if name and (os.path.exists(name) or "/" not in str(name)):
            return c.CDLL(str(name))
    raise ImportError("osteon: found no libosteon.so.0; accepted: an installation, or its path in $OSTEON_LIBRARY")


_lib = _load()
for _name, _result, _arguments in [
    ("version", c.c_char_p, []),
    ("abi", c.c_uint32, []),
    ("result_text", c.c_char_p, [c.c_int]),
    ("last_error", c.c_char_p, []),
    ("bone_params_init", c.c_int, [c.c_uint32, c.POINTER(_BoneParams)]),
    ("bone_create", c.c_int, [c.c_uint32, c.POINTER(_BoneParams), c.POINTER(c.c_void_p)]),
    ("bone_destroy", None, [c.c_void_p]),
    ("bone_info", c.c_int, [c.c_void_p, c.POINTER(_BoneInfo)]),
    ("bone_warning", c.c_char_p, [c.c_void_p]),
    ("bone_material", c.c_char_p, [c.c_void_p, c.c_uint32]),
    ("bone_material_color", c.c_int, [c.c_void_p, c.c_uint32, c.POINTER(c.c_uint8)]),
    ("bone_approach", c.c_int, [c.c_void_p, c.c_double, c.POINTER(_Pose)]),
    ("tool_params_init", c.c_int, [c.c_uint32, c.POINTER(_ToolParams)]),
    ("tool_create", c.c_int, [c.c_uint32, c.POINTER(_ToolParams), c.POINTER(c.c_void_p)]),
    ("tool_destroy", None, [c.c_void_p]),
    ("tool_spindle_rad_per_s", c.c_double, [c.c_void_p]),
    ("settings_init", c.c_int, [c.c_uint32, c.POINTER(_Settings)]),
    ("session_create", c.c_int, [c.c_uint32, c.c_void_p, c.c_void_p, c.POINTER(_Settings), c.POINTER(c.c_void_p)]),
    ("session_destroy", None, [c.c_void_p]),
    ("session_engine", c.c_char_p, [c.c_void_p]),
    ("session_set_log", c.c_int, [c.c_void_p, _LogCallback, c.c_void_p]),
    ("session_set_tool_pose", c.c_int, [c.c_void_p, c.POINTER(_Pose), c.c_double]),
    ("session_step", c.c_int, [c.c_void_p, c.POINTER(_Pose), c.c_double, c.c_double]),
    ("session_evaluate", c.c_int, [c.c_void_p, c.POINTER(_Pose), c.POINTER(_Twist), c.POINTER(_Wrench)]),
    ("session_figures", c.c_int, [c.c_void_p, c.POINTER(_Figures)]),
    ("session_next_event", c.c_int, [c.c_void_p, c.POINTER(_Event)]),
    ("session_change_tool", c.c_int, [c.c_void_p, c.c_void_p, c.POINTER(_Pose)]),
    ("compliance_params_init", c.c_int, [c.c_uint32, c.POINTER(_ComplianceParams)]),
    ("session_set_compliance", c.c_int, [c.c_uint32, c.c_void_p, c.POINTER(_ComplianceParams)]),
    ("session_deflection", c.c_int, [c.c_void_p, c.POINTER(_Deflection)]),
    ("session_mark", c.c_int, [c.c_void_p]),
    ("session_undo", c.c_int, [c.c_void_p, c.POINTER(_Pose)]),
    ("session_save", c.c_int, [c.c_void_p, c.c_char_p]),
    ("session_restore", c.c_int, [c.c_void_p, c.c_char_p, c.POINTER(_Pose)]),
    ("session_surface_changes", c.c_int, [c.c_void_p, c.POINTER(c.c_uint64), c.POINTER(_Buffers)]),
    ("session_surface_wait", c.c_int, [c.c_void_p]),
    ("session_surface_export", c.c_int, [c.c_void_p, c.c_char_p, c.POINTER(_SurfaceInfo)]),
    ("plan_params_init", c.c_int, [c.c_uint32, c.POINTER(_PlanParams)]),
    ("plan_create", c.c_int, [c.c_uint32, c.POINTER(_PlanParams), c.POINTER(c.c_void_p)]),
    ("plan_destroy", None, [c.c_void_p]),
    ("plan_info", c.c_int, [c.c_void_p, c.POINTER(_PlanInfo)]),
    ("plan_reamer", c.c_int, [c.c_void_p, c.c_uint32, c.POINTER(_Reamer)]),
    ("guidance_params_init", c.c_int, [c.c_uint32, c.POINTER(_GuidanceParams)]),
    ("guidance_create", c.c_int, [c.c_uint32, c.c_void_p, c.POINTER(_GuidanceParams), c.POINTER(c.c_void_p)]),
    ("guidance_destroy", None, [c.c_void_p]),
    ("guidance_evaluate", c.c_int, [c.c_void_p, c.POINTER(_Pose), c.POINTER(_Twist), c.POINTER(_Wrench), c.POINTER(_GuidanceOutput)]),
    ("guidance_set_gain", c.c_int, [c.c_void_p, c.c_double]),
    ("guidance_set_model_age", c.c_int, [c.c_void_p, c.c_double]),
    ("guidance_reset", c.c_int, [c.c_void_p]),
    ("session_assess", c.c_int, [c.c_void_p, c.c_void_p, c.POINTER(_Assessment), c.POINTER(_ScoreItem), c.c_size_t, c.POINTER(c.c_size_t)]),
]:
    _function = getattr(_lib, "osteon_" + _name)
    _function.restype, _function.argtypes = _result, _arguments
if _lib.osteon_abi() != _ABI:
    raise ImportError(f"osteon: found a library of ABI {_lib.osteon_abi()}, accepted ABI {_ABI}, that of this file")


def _check(code):
    """Returns an OsteonResult. Raises Error with the library's text if it is a failure."""
    if code < 0:
        raise Error(code, _lib.osteon_last_error().decode())
    return code
