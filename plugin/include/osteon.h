// osteon.h: Osteon's cutting engine for other programs.
//
//     OsteonBone ──┐                       threads of its own: engine, removal, surface
//                  ├─▶ OsteonSession ◀──── osteon_session_set_tool_pose   the device's or game's thread
//     OsteonTool ──┘         └───────────▶ osteon_session_evaluate        that thread or another one: 1 kHz
//
// C11, no dependency. Units are SI unless a name says otherwise (_mm). Frames: everything is in the bone's
// frame G, right-handed; the tool's frame T has its origin at the apex and +z along the feed. Quaternions are
// w x y z and need not be normalised.
//
// Results. Every function that can fail returns an OsteonResult. osteon_last_error() has the text of the
// calling thread's last failure: the name of the value, what was found, what is accepted. The library raises
// no signal, prints nothing, and lets no exception through. If an argument is null although the function's
// comment does not allow it, or a number is not finite, the function returns OSTEON_ERROR_ARGUMENT. A call
// that fails changes nothing, unless the function's comment says otherwise.
//
// Threads. In one session, one thread at a time may call set_tool_pose, and one thread at a time may call
// evaluate; these may be two threads or the same one. These two functions never wait, lock or allocate. All
// other functions may be called from any thread at any time, and wait for the frame that is being computed.
//
// One thread at a time may call the functions of one guidance. They never wait, lock or allocate, except
// create and destroy. Different guidances share no data, so different threads may use them.
//
// Lifetime. Bones and tools may be destroyed while sessions use them, plans while guidances use them.
// osteon_session_destroy joins the session's threads. The library detects neither a second destroy nor a
// call with a destroyed object: these are errors of the caller. If a process has made an object of this
// library and then calls fork(), every create function and every function of a session returns
// OSTEON_ERROR_FORK in the child. The child must start a new program instead (exec, spawn).
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define OSTEON_VERSION "1.0.0"
/* Changes whenever a struct or the meaning of a function does. Pass it where a function asks for it: the
 * library refuses another one with a message that names both. Functions without this argument take an object
 * that such a function made. Only osteon_*_default write a struct unchecked: they fill those of ABI 1. A
 * program that may meet another library calls osteon_*_init instead, which refuse another ABI before they
 * write. */
#define OSTEON_ABI 1u

#if defined(__GNUC__)
#define OSTEON_API __attribute__((visibility("default")))
#else
#define OSTEON_API
#endif

typedef enum OsteonResult {
  OSTEON_OK = 0,
  OSTEON_EMPTY = 1,           /* no event waits; not an error */
  OSTEON_ERROR_ARGUMENT = -1, /* a value that is null, not finite or out of range */
  OSTEON_ERROR_FILE = -2,     /* a file that cannot be read or written, or has a defect */
  OSTEON_ERROR_MEMORY = -3,   /* no memory */
  OSTEON_ERROR_DEVICE = -4,   /* no such GPU, it was lost, or it cannot hold bone and tool */
  OSTEON_ERROR_STATE = -5,    /* not possible now: the text says what has to happen first */
  OSTEON_ERROR_ABI = -6,      /* header and library have different ABIs */
  OSTEON_ERROR_FORK = -7,     /* called in a forked child */
  OSTEON_ERROR_BUFFER = -8,   /* a buffer is smaller than the worst case that its comment names */
  OSTEON_ERROR_INTERNAL = -9  /* a defect of the library; please report the text */
} OsteonResult;

typedef enum OsteonEngine {
  OSTEON_ENGINE_AUTO = 0, /* Vulkan if there is a GPU, else the processor */
  OSTEON_ENGINE_CPU = 1,
  OSTEON_ENGINE_VULKAN = 2
} OsteonEngine;

/* Pose of T in G. */
typedef struct OsteonPose {
  double position_m[3];       /* each within -1000 … 1000 */
  double orientation_wxyz[4]; /* of any length but 0; the library's own have length 1 */
} OsteonPose;

/* Velocity of T at its origin, in G. */
typedef struct OsteonTwist {
  double linear_m_per_s[3];
  double angular_rad_per_s[3];
} OsteonTwist;

/* Wrench on the tool, at T's origin, in G. */
typedef struct OsteonWrench {
  double force_N[3];
  double torque_Nm[3];
} OsteonWrench;

typedef struct OsteonBone OsteonBone;
typedef struct OsteonTool OsteonTool;
typedef struct OsteonSession OsteonSession;
typedef struct OsteonPlan OsteonPlan;
typedef struct OsteonGuidance OsteonGuidance;

/* --- library ------------------------------------------------------------------------------------------- */

/* "1.0.0"; valid for ever. */
OSTEON_API const char* osteon_version(void);
/* The OSTEON_ABI that the library was built with. */
OSTEON_API uint32_t osteon_abi(void);
/* Meaning of a result, in a few words; valid for ever. */
OSTEON_API const char* osteon_result_text(OsteonResult result);
/* Text of the calling thread's last failure, one line, UTF-8, at most 1023 bytes; "" where there was none.
 * Valid until this thread's next failure: a success does not clear it. */
OSTEON_API const char* osteon_last_error(void);

/* --- bone ---------------------------------------------------------------------------------------------- */

/* Source of a bone: exactly one of packing_file, mesh_file, balls and, if none of these, scene. */
typedef struct OsteonBoneParams {
  const char* scene; /* name of a shipped scene, or its YAML file: "acetabulum", "molar", …; for a mesh, the
                        scene whose tissues and fineness it gets. Null: "acetabulum" */
  const char* mesh_file; /* STL, OBJ or PLY; needs the site. A surface that bounds no solid, such as an open
                            one, is remade as one, and osteon_bone_warning says how; what cannot be is
                            refused. Its frame is G. Null: none */
  double mesh_scale_mm;  /* millimetres per unit of the mesh, 1e-6 … 1e6; 0: 1 */
  const char* packing_file; /* as `osteon pack` writes it (.osp). Null: none */
  const float* balls_mm; /* x y z r of ball_count overlapping balls in G [mm], within 10 m. Null: none. Their
                            mass is sampled at 0.75 mm, all of the first material */
  size_t ball_count;     /* 1 … 100 000 000; 0 without balls */
  const char* material;  /* of balls: name of a shipped material. Null: "cancellous" */
  double site_center_m[3];   /* in G, where it is cut: centre of the cup, or of the entry on the surface; each
                                within -1000 … 1000 */
  double site_axis[3];       /* in G, out of the bone; any length but 0 */
  double site_radius_m;      /* 0: the scene's or the packing's own site; a mesh needs one. At most 10 */
  const char* config_folder; /* folder of scenes/, materials/ and tools/. Null: that of the installation or
                                checkout that the library lies in, or $OSTEON_ROOT/config */
} OsteonBoneParams;

/* Fills params with zeros: the scene "acetabulum". Null is allowed. */
OSTEON_API void osteon_bone_params_default(OsteonBoneParams* params);
/* Fills params as osteon_bone_params_default does; params may not be null. abi: OSTEON_ABI. Where it is not
 * the library's, returns OSTEON_ERROR_ABI and writes nothing. Any thread. */
OSTEON_API OsteonResult osteon_bone_params_init(uint32_t abi, OsteonBoneParams* params);

/* Makes a bone; takes 0.1 s (scene) to half a minute (large mesh). Any thread.
 * abi: OSTEON_ABI. params: not null. bone: not null; receives the new bone, null on failure.
 * OSTEON_ERROR_FILE: no such scene, mesh, packing or folder, or one with a defect; OSTEON_ERROR_ARGUMENT:
 * balls, site or scale out of range, or more than one source. */
OSTEON_API OsteonResult osteon_bone_create(uint32_t abi, const OsteonBoneParams* params, OsteonBone** bone);
/* Destroys the bone; sessions that use it keep what they need. Null is allowed. */
OSTEON_API void osteon_bone_destroy(OsteonBone* bone);
/* The assumptions that made a solid of a mesh that bounds none: its defects (open edges, …) and how they were
 * mended, one line, UTF-8; "" if there were none, and for null. Valid as long as the bone. Show it to a
 * person: a bone that was remade may lack what the file meant. */
OSTEON_API const char* osteon_bone_warning(const OsteonBone* bone);

typedef struct OsteonBoneInfo {
  uint64_t balls;
  uint64_t mass_points;
  double volume_m3; /* sum over the mass points */
  double mass_kg;
  double site_center_m[3]; /* in G */
  double site_axis[3];     /* unit, out of the bone, in G */
  double site_radius_m;
  uint32_t material_count;
} OsteonBoneInfo;

/* Fills info with the bone's figures before anything is cut: they never change. Neither pointer may be null.
 * Any thread; takes some milliseconds (it sums over the mass points). */
OSTEON_API OsteonResult osteon_bone_info(const OsteonBone* bone, OsteonBoneInfo* info);
/* Name of a material, for the indices of OsteonVertex; null if there is no such index. Valid as long as
 * the bone. */
OSTEON_API const char* osteon_bone_material(const OsteonBone* bone, uint32_t index);
/* Colour of a material in shaded pictures: red, green, blue as sRGB, 0 … 255. The table for a mesh's vertex
 * colours has material_count of them (OsteonBoneInfo). */
OSTEON_API OsteonResult osteon_bone_material_color(const OsteonBone* bone, uint32_t index, uint8_t rgb[3]);
/* Pose of T in G of a tool that points into the site along its axis, its apex `height_m` above the site's
 * centre (below where negative; -1 … 1). At 0 a reamer that fits the cup is free of bone. Any thread. */
OSTEON_API OsteonResult osteon_bone_approach(const OsteonBone* bone, double height_m, OsteonPose* pose);

/* --- tool ---------------------------------------------------------------------------------------------- */

typedef struct OsteonToolParams {
  const char*
      name; /* shipped tool, or its YAML file: "reamer", "twist_drill", "round_burr", … Null: "reamer" */
  double diameter_m;     /* one of the sizes that the tool comes in; 0: its usual one. Another is refused with
                            OSTEON_ERROR_ARGUMENT and the sizes that there are */
  const float* balls_mm; /* instead of a name: x y z r of ball_count balls in T [mm]. Null: none */
  const uint8_t* cutting;    /* for each ball, 0: it touches only. Null: all cut */
  size_t ball_count;         /* 1 … 10 000: a session refuses more */
  const char* config_folder; /* as in OsteonBoneParams */
} OsteonToolParams;

/* Fills params with zeros: the reamer in its usual size. Null is allowed. Any thread. */
OSTEON_API void osteon_tool_params_default(OsteonToolParams* params);
/* Fills params as osteon_tool_params_default does; otherwise as osteon_bone_params_init. */
OSTEON_API OsteonResult osteon_tool_params_init(uint32_t abi, OsteonToolParams* params);
/* Makes a tool, which never changes and may serve many sessions; takes some milliseconds.
 * abi: OSTEON_ABI. params: not null. tool: not null; receives the new tool, null on failure. */
OSTEON_API OsteonResult osteon_tool_create(uint32_t abi, const OsteonToolParams* params, OsteonTool** tool);
/* Destroys the tool; sessions that use it keep what they need. Null is allowed. */
OSTEON_API void osteon_tool_destroy(OsteonTool* tool);
/* The tool's usual spindle speed [rad/s]; 0 for a tool of balls, or null. */
OSTEON_API double osteon_tool_spindle_rad_per_s(const OsteonTool* tool);

/* --- session ------------------------------------------------------------------------------------------- */

typedef struct OsteonSettings {
  uint32_t engine;          /* an OsteonEngine */
  const char* device;       /* part of a GPU's name; null: the default GPU */
  uint32_t lockstep;        /* 0: frames are computed in the session's own thread as poses come, in wall time.
                               1: osteon_session_step computes them, and nothing else does: same input, same bits */
  uint32_t surface;         /* 1: the carved surface is made (a thread of its own, at idle priority) */
  double max_force_N;       /* of the wrench: above 0, at most 200 */
  double max_torque_Nm;     /* of the wrench: above 0, at most 20 */
  double stiffness_N_per_m; /* of the coupling between tool and bone */
  double damping_Ns_per_m;  /* of the coupling */
} OsteonSettings;

/* Fills settings with: auto, own thread, with a surface, 200 N, 20 N·m, 20 kN/m, 100 N·s/m. May be null. */
OSTEON_API void osteon_settings_default(OsteonSettings* settings);
/* Fills settings as osteon_settings_default does; otherwise as osteon_bone_params_init. */
OSTEON_API OsteonResult osteon_settings_init(uint32_t abi, OsteonSettings* settings);

/* Makes a session with its engine and threads; takes up to some seconds (GPU, large mesh). Any thread.
 * abi: OSTEON_ABI. bone and tool: not null. settings: null for the defaults. session: not null; receives it,
 * null on failure. OSTEON_ERROR_DEVICE: no such GPU, or the tool has too many balls; OSTEON_ERROR_ARGUMENT: a
 * setting out of range. */
OSTEON_API OsteonResult osteon_session_create(uint32_t abi, const OsteonBone* bone, const OsteonTool* tool,
                                              const OsteonSettings* settings, OsteonSession** session);
/* Ends and joins its threads. No other call on this session may run. Null is allowed. */
OSTEON_API void osteon_session_destroy(OsteonSession* session);
/* "cpu on one thread, AVX-512 (…)"; "" for null. Valid as long as the session. */
OSTEON_API const char* osteon_session_engine(const OsteonSession* session);

typedef enum OsteonLogLevel {
  OSTEON_LOG_INFO = 0,
  OSTEON_LOG_WARNING = 1,
  OSTEON_LOG_ERROR = 2
} OsteonLogLevel;
/* Receives one line of text, UTF-8, valid during the call. It must return soon, and must call no function of
 * the session, which would wait for ever. Exceptions of it (C++) end in the library. */
typedef void (*OsteonLogCallback)(void* user, uint32_t level, const char* text);

/* From now on, `callback` is told what happens in the session: at once its engine, and as a warning what
 * osteon_bone_warning says, if anything; then each event of the scene, a first pose that is in bone, changes
 * of tool or bone, and the end of its engine. It is called from the session's own thread, or from the thread
 * of the call that it is about; never from set_tool_pose or evaluate, and never by two threads at a time.
 * Null: nobody. After this function has returned, an earlier callback is not called any more. */
OSTEON_API OsteonResult osteon_session_set_log(OsteonSession* session, OsteonLogCallback callback,
                                               void* user);

/* Where the tool is, and its spindle's speed [rad/s] (0: it does not cut; below 1e6, of either sign). The
 * first pose of a session must be free of bone: until one is, no frame is computed, osteon_session_figures
 * returns OSTEON_ERROR_STATE, and the log is told. If poses come faster than frames are computed, only
 * the newest pose counts. Wait-free. OSTEON_ERROR_STATE in lockstep. */
OSTEON_API OsteonResult osteon_session_set_tool_pose(OsteonSession* session, const OsteonPose* pose,
                                                     double spindle_rad_per_s);

/* Lockstep: computes one frame at this pose and moves the session's clock on by dt_s [s] (0 … 0.1). The
 * spindle [rad/s] as above. OSTEON_ERROR_STATE: the session has its own thread, or the first pose is in bone;
 * OSTEON_ERROR_DEVICE: the GPU was lost, or more bone is near than the engine has room for. The clock moves
 * on all the same. */
OSTEON_API OsteonResult osteon_session_step(OsteonSession* session, const OsteonPose* pose,
                                            double spindle_rad_per_s, double dt_s);

/* The coupling wrench at this pose and velocity, from the newest frame: what the hand should feel. |force|
 * and |torque| are within the settings' limits, always. It fades to zero while the newest frame's pose is 20
 * to 60 ms old, and after the first call, or a change of tool or bone, it fades in within 100 ms. Wait-free:
 * no lock, no allocation. On failure the wrench is zero. twist: null for rest. */
OSTEON_API OsteonResult osteon_session_evaluate(OsteonSession* session, const OsteonPose* pose,
                                                const OsteonTwist* twist, OsteonWrench* wrench);

typedef struct OsteonFigures {
  uint64_t frame;              /* number of frames computed so far */
  double pose_age_s;           /* age of the newest frame's tool pose */
  double frame_time_s;         /* time that the newest frame took; 0 in lockstep */
  OsteonPose proxy;            /* collision-free pose of the tool in the newest frame */
  OsteonWrench wrench;         /* of the newest frame's own pose, before limits */
  double removed_volume_m3;    /* since the start */
  double removed_mass_kg;      /* since the start */
  double cutting_work_J;       /* since the start */
  double spindle_torque_Nm;    /* of the cut */
  double engaged_area_m2;      /* of the cutting surface */
  double depth_m;              /* of the apex below the site's first floor, along its axis; negative above */
  uint32_t contacts;           /* contact planes of the newest frame */
  uint32_t reserved;           /* 0 */
  uint64_t skipped_on_surface; /* frames that the surface's thread was too late for; their way is carved
                                  straight */
} OsteonFigures;

/* Fills figures with those of the newest frame; before the first frame they are zero, and proxy is no pose.
 * Waits for the frame that is being computed (below a millisecond as a rule): not for a loop in real time.
 * Neither pointer may be null. Any thread. */
OSTEON_API OsteonResult osteon_session_figures(OsteonSession* session, OsteonFigures* figures);

typedef struct OsteonEvent {
  char name[48];        /* "pulp reached", "wall too thin", "breakthrough" */
  double value_m;       /* depth, or thickness of the wall */
  double position_m[3]; /* in G */
  uint64_t frame;       /* number of the frame in which it happened */
} OsteonEvent;

/* Takes the oldest event of the scene that was not taken. Returns OSTEON_EMPTY where none waits; event is
 * left as it was then. At most 256 wait: later ones are told to the log alone. Any thread. */
OSTEON_API OsteonResult osteon_session_next_event(OsteonSession* session, OsteonEvent* event);

/* Changes to another tool, at `pose` (T in G), which must be free of bone: else OSTEON_ERROR_STATE, and
 * nothing changes. Waits for the surface, and makes a new engine: some ms to a second. */
OSTEON_API OsteonResult osteon_session_change_tool(OsteonSession* session, const OsteonTool* tool,
                                                   const OsteonPose* pose);

/* --- compliance of tool, tissue and mount ----------------------------------------------------------------
 */

/* Compliance of each part (docs/compliance.md). With all three off, nothing yields. */
typedef struct OsteonComplianceParams {
  uint32_t tool;     /* 1: the tool bends as `bending` of its file says */
  uint32_t layer;    /* 1: soft tissue on the surface yields as the bone's materials say */
  uint32_t mount;    /* 1: the bone moves on the mount below */
  uint32_t reserved; /* 0 */
  double period_s;  /* between two calls of osteon_session_evaluate, which moves these parts: 0.1 … 20 ms */
  double push_N;    /* largest thrust along the feed; a thin tool is softer under it */
  double noticed_m; /* a displacement beyond it is reported: 1 um … 0.1 m */
  double mount_point_m[3]; /* centre of the mount's stiffness, in G; the triples below are along G's axes */
  double mount_mass_kg;
  double mount_inertia_kg_m2[3];
  double mount_stiffness_N_per_m[3];
  double mount_stiffness_Nm_per_rad[3];
  double mount_damping_ratio; /* of each axis by itself: at least 0.05 */
  double mount_creep_N_per_m; /* of the pads; 0: they do not creep */
  double mount_creep_s;       /* time constant of the pads */
} OsteonComplianceParams;

/* Fills params with: all off; 1 ms, 60 N, 0.1 mm; a mount of 12 kg and 10 Hz about G's origin. Otherwise as
 * osteon_bone_params_init. */
OSTEON_API OsteonResult osteon_compliance_params_init(uint32_t abi, OsteonComplianceParams* params);

/* From the next osteon_session_evaluate on, these parts are compliant, from rest; the force fades in as after
 * a change of tool. params: null, or all off: nothing yields. The poses that a caller passes stay those of
 * the rigid tool in G, where the bone rested; the bone's figures, events and surface stay in the bone, which
 * is drawn at OsteonDeflection.bone. Refuses a tool or a bone whose files do not say how they give way, and
 * what would not be stable with settings.stiffness_N_per_m, naming the value that is needed. The hand's part
 * in it is the caller's. osteon_session_change_tool refuses a tool whose bending is not known while `tool` is
 * on. Each call keeps 1 kB until the session ends. */
OSTEON_API OsteonResult osteon_session_set_compliance(uint32_t abi, OsteonSession* session,
                                                      const OsteonComplianceParams* params);

typedef struct OsteonDeflection {
  OsteonPose head;                 /* pose of the bent tool in the bone, which the engine uses */
  OsteonPose bone;                 /* pose of the bone in G, at which to draw it */
  double bend_m[3], bend_rad[3];   /* of the tool's head, in T */
  double layer_m[3];               /* of the tissue at the contact, in the bone */
  double mount_m[3], mount_rad[3]; /* of the bone at the mount's point, pads included, in G */
  double mount_m_per_s[3], mount_rad_per_s[3];
  uint32_t gives_way; /* 1: by the last osteon_session_evaluate; 0: nothing does, and all above is at rest */
  uint32_t noticed;   /* 1: a displacement beyond noticed_m */
  uint32_t beyond_limit; /* 1: a lateral bend of more than a tenth of the free length, a thrust of more than
                            half of the buckling load, a mount that moved by more than 10 mm or 0.1 rad: the
                            caller should stop, as the servo loop does */
  uint32_t reserved;     /* 0 */
} OsteonDeflection;

/* Fills deflection with the displacements after the newest osteon_session_evaluate. Neither pointer may be
 * null. Any thread; waits for the frame that is being computed. */
OSTEON_API OsteonResult osteon_session_deflection(OsteonSession* session, OsteonDeflection* deflection);

/* --- save, restore, undo ---------------------------------------------------------------------------------
 */

/* Marks the present bone for osteon_session_undo; the oldest of more than 16 is forgotten. Waits for
 * the surface. */
OSTEON_API OsteonResult osteon_session_mark(OsteonSession* session);
/* Returns to the last mark and forgets it. `pose` is where the tool is: it must be free of the bone that
 * comes back, else OSTEON_ERROR_STATE, and nothing changes. */
OSTEON_API OsteonResult osteon_session_undo(OsteonSession* session, const OsteonPose* pose);
/* Saves the carved bone as FILE and, with a surface, FILE.swept. Each file appears whole or not at all; where
 * it fails, earlier files of these names stay. OSTEON_ERROR_FILE: the folder is not there or not writable, or
 * the name is that of a folder, device or pipe. */
OSTEON_API OsteonResult osteon_session_save(OsteonSession* session, const char* file);
/* Returns to a saved bone of the same OsteonBone; any tool. `pose` as for undo. OSTEON_ERROR_FILE: the file
 * is damaged, or of another bone; with a surface, FILE.swept has to be there as well. Nothing changes then.
 */
OSTEON_API OsteonResult osteon_session_restore(OsteonSession* session, const char* file,
                                               const OsteonPose* pose);

/* --- surface ---------------------------------------------------------------------------------------------
 */

typedef struct OsteonVertex {
  float position_mm[3]; /* in G */
  float normal[3];      /* unit, outward, in G */
  uint8_t material;     /* index for osteon_bone_material */
  uint8_t cut;          /* 1: on a face that the tool cut */
  uint8_t reserved[2];  /* 0 */
} OsteonVertex;

/* The mesh of one brick, replacing the earlier one of the same brick. */
typedef struct OsteonChunk {
  uint32_t brick;
  uint32_t first_vertex, vertex_count; /* in the buffer's vertices */
  uint32_t first_index, index_count;   /* in the buffer's indices: triangles, counter-clockwise from outside,
                                          each index counted from the chunk's first vertex */
  uint32_t reserved;                   /* 0 */
} OsteonChunk;

/* Worst case of one chunk. */
#define OSTEON_CHUNK_MAX_VERTICES 5832u
#define OSTEON_CHUNK_MAX_INDICES 9216u

/* The caller's buffers, and what was filled. */
typedef struct OsteonSurfaceBuffers {
  OsteonChunk* chunks;
  OsteonVertex* vertices; /* room for at least OSTEON_CHUNK_MAX_VERTICES */
  uint16_t* indices;      /* room for at least OSTEON_CHUNK_MAX_INDICES */
  size_t chunk_capacity, vertex_capacity, index_capacity;
  size_t chunk_count, vertex_count, index_count; /* filled */
  uint64_t left;                                 /* changed chunks that did not fit: call again */
} OsteonSurfaceBuffers;

/* Copies the chunks that changed after `*generation`, the longest unchanged first, and moves *generation on;
 * begin with 0. A chunk without vertices was removed. Chunks change at most 30 times a second. Several
 * callers may each have a generation of their own. No pointer may be null, nor any of the three buffers.
 * OSTEON_ERROR_BUFFER: less room than for one chunk; OSTEON_ERROR_STATE: a session without a surface, or its
 * surface could not be made; OSTEON_ERROR_ARGUMENT: a generation of another session. Any thread; no frame
 * waits for it. */
OSTEON_API OsteonResult osteon_session_surface_changes(OsteonSession* session, uint64_t* generation,
                                                       OsteonSurfaceBuffers* buffers);
/* Waits until all frames so far are in the surface (seconds after the start of a large mesh).
 * OSTEON_ERROR_STATE as for osteon_session_surface_changes. */
OSTEON_API OsteonResult osteon_session_surface_wait(OsteonSession* session);

typedef struct OsteonSurfaceInfo {
  uint64_t triangles;
  double volume_m3;    /* enclosed by the mesh */
  uint32_t watertight; /* 1: every edge has two triangles of the same winding */
  uint32_t reserved;   /* 0 */
} OsteonSurfaceInfo;

/* Writes the carved bone as one watertight mesh in millimetres, in G: .stl, .ply or .obj by the file's name.
 * The file appears whole or not at all. info: may be null. Waits for the surface. OSTEON_ERROR_STATE as for
 * osteon_session_surface_changes; OSTEON_ERROR_ARGUMENT: another ending; OSTEON_ERROR_FILE: cannot be
 * written. */
OSTEON_API OsteonResult osteon_session_surface_export(OsteonSession* session, const char* file,
                                                      OsteonSurfaceInfo* info);

/* --- surgical plan ---------------------------------------------------------------------------------------
 */

typedef struct OsteonPlanParams {
  const char* plan;   /* name of a shipped plan, or its YAML file (docs/procedure.md). Null: "acetabulum" */
  const char* rubric; /* what scores: name of a shipped rubric, or its YAML file. Null: by the plan's kind */
  const char* config_folder; /* as in OsteonBoneParams */
} OsteonPlanParams;

/* Fills params with null: the plan "acetabulum". Null is allowed. */
OSTEON_API void osteon_plan_params_default(OsteonPlanParams* params);
/* Fills params as osteon_plan_params_default does; otherwise as osteon_bone_params_init. */
OSTEON_API OsteonResult osteon_plan_params_init(uint32_t abi, OsteonPlanParams* params);
/* Reads a plan, which never changes. abi: OSTEON_ABI. params: not null. plan: not null; receives it, null on
 * failure. OSTEON_ERROR_FILE: no such plan or rubric, or one with a defect. Any thread. */
OSTEON_API OsteonResult osteon_plan_create(uint32_t abi, const OsteonPlanParams* params, OsteonPlan** plan);
/* Destroys the plan; guidances that use it keep what they need. Null is allowed. */
OSTEON_API void osteon_plan_destroy(OsteonPlan* plan);

typedef struct OsteonCupAngles {
  double inclination_rad;
  double anteversion_rad;
} OsteonCupAngles;

/* In a plan for an opening, its centre, axis and width stand for the cup's, and burrs for reamers; native
   centre and angles are NaN. */
typedef struct OsteonPlanInfo {
  double cup_center_m[3]; /* planned, in G */
  double cup_axis[3];     /* unit, out of the opening, in G */
  double cup_diameter_m;  /* of the implant */
  double native_center_m[3];
  OsteonCupAngles radiographic, operative, anatomic; /* of the axis, in the three definitions */
  uint32_t reamer_count;
  uint32_t is_left;      /* 1: a left hip */
  uint32_t has_guidance; /* 1: osteon_guidance_create accepts it */
  uint32_t reserved;     /* 0 */
} OsteonPlanInfo;

/* Fills info with where the plan wants the cup, its angles in three definitions, and how many reamers lead
 * there. Neither pointer may be null. Any thread; never waits. */
OSTEON_API OsteonResult osteon_plan_info(const OsteonPlan* plan, OsteonPlanInfo* info);

typedef struct OsteonReamer {
  double diameter_m;
  double center_m[3]; /* planned position of the head's centre, in G */
  double apex_m[3];   /* planned position of T's origin, in G */
} OsteonReamer;

/* A reamer of the plan's sequence, by its index: 0 … reamer_count - 1 (OsteonPlanInfo), else
 * OSTEON_ERROR_ARGUMENT. Any thread. */
OSTEON_API OsteonResult osteon_plan_reamer(const OsteonPlan* plan, uint32_t index, OsteonReamer* reamer);

/* --- guidance along a plan -------------------------------------------------------------------------------
 */

typedef struct OsteonGuidanceParams {
  uint32_t reamer;          /* index of the plan's reamer that is in use */
  uint32_t reserved;        /* 0 */
  double gain;              /* 0 … 1; negative: the plan's own */
  double max_force_N;       /* of guidance and the other wrench together: above 0, at most 200 */
  double max_torque_Nm;     /* of both together: above 0, at most 20 */
  double max_speed_m_per_s; /* of the tool: above 0. A force that grows faster than it allows is a jump */
  double period_s;          /* between two calls of osteon_guidance_evaluate: above 0, at most 0.1 */
} OsteonGuidanceParams;

/* Fills params with: the first reamer, the plan's own gain, 200 N, 20 N·m, 0.25 m/s, 1 ms. Null is allowed.
 */
OSTEON_API void osteon_guidance_params_default(OsteonGuidanceParams* params);
/* Fills params as osteon_guidance_params_default does; otherwise as osteon_bone_params_init. */
OSTEON_API OsteonResult osteon_guidance_params_init(uint32_t abi, OsteonGuidanceParams* params);
/* Makes the guidance of one reamer: a funnel, a cone of tilt and a depth (docs/theory/guidance.md).
 * OSTEON_ERROR_STATE if the plan has none. params: null for the defaults. */
OSTEON_API OsteonResult osteon_guidance_create(uint32_t abi, const OsteonPlan* plan,
                                               const OsteonGuidanceParams* params, OsteonGuidance** guidance);
/* Ends a guidance. No other call on it may run. Null is allowed. */
OSTEON_API void osteon_guidance_destroy(OsteonGuidance* guidance);

typedef struct OsteonGuidanceOutput {
  OsteonWrench wrench;   /* to add to the wrench passed as `other` */
  double cone_rad;       /* how far the tool is outside: angle beyond the free cone; <= 0: inside */
  double lateral_m;      /* distance outside the funnel; <= 0: inside */
  double depth_m;        /* how much deeper than planned; <= 0: not deeper */
  double share;          /* share of the guidance that is rendered, 0 … 1 */
  double potential_J;    /* energy that the guidance could still give, at share 1 */
  double energy_J;       /* energy given so far; never above -share potential_J (within rounding) */
  uint32_t inside;       /* 1: inside of everything, no wrench */
  uint32_t stop_spindle; /* 1: beyond a stop of the plan, until the tool is inside of everything */
  uint32_t jumped;   /* 1: the force would have grown faster than max_speed_m_per_s explains; the wrench is
                        zero, and the guidance begins anew */
  uint32_t reserved; /* 0 */
} OsteonGuidanceOutput;

/* The guidance at this pose and velocity; call it once in each period. `other`: the wrench that is rendered
 * beside it (that of osteon_session_evaluate): the sum stays within the limits, and `other` comes first;
 * null: none. twist: null for rest. As in the servo loop, the guidance gives no energy that it has not taken:
 * switched on outside of its corridor it waits until the tool has been inside. The numbers are those of the
 * servo loop's own guidance at the same poses and the same age of the contact model. Wait-free: no lock, no
 * allocation. On failure the wrench is zero. */
OSTEON_API OsteonResult osteon_guidance_evaluate(OsteonGuidance* guidance, const OsteonPose* pose,
                                                 const OsteonTwist* twist, const OsteonWrench* other,
                                                 OsteonGuidanceOutput* output);
/* Sets the gain, 0 … 1. The share falls to it at once, and rises to it as the energy allows. Wait-free. */
OSTEON_API OsteonResult osteon_guidance_set_gain(OsteonGuidance* guidance, double gain);
/* Age of the contact model that `other` is made of (OsteonFigures.pose_age_s): the guidance counts in full
 * up to 20 ms and not at all from 60 ms on, and comes back within 0.1 s, as the servo loop's. Without this
 * call the model counts as fresh. It holds until the next one. Wait-free. */
OSTEON_API OsteonResult osteon_guidance_set_model_age(OsteonGuidance* guidance, double age_s);
/* Restarts with no energy and no share. Call it after a change of tool or a jump of the pose. Wait-free. */
OSTEON_API OsteonResult osteon_guidance_reset(OsteonGuidance* guidance);

/* --- assessment ------------------------------------------------------------------------------------------
 */

/* The reamed bone, compared with the plan (docs/procedure.md). A figure that cannot be measured is NaN. */
typedef struct OsteonAssessment {
  double score;                             /* 0 … the rubric's points */
  double axis_error_rad;                    /* of the tool, weighted by the volume that it removed
                                               since the last change of tool; NaN: it cut nothing, or
                                               the bone was restored from a file */
  double diameter_m, diameter_sd_m;         /* fitted sphere; sd: standard deviation */
  double center_m[3];                       /* in G */
  double form_p95_m;                        /* 95th percentile of the residuals */
  double medial_m, superior_m, posterior_m; /* shift of the centre from the planned one */
  double native_medial_m, native_superior_m, native_posterior_m; /* … from the native one */
  double coverage;                                               /* 0 … 1 */
  double removed_m3, over_m3, under_m3;
  double cartilage_left, rim_preserved; /* 0 … 1 */
  double min_wall_m;                    /* thinnest wall beside the cut; <= 0: a breach */
} OsteonAssessment;

typedef struct OsteonScoreItem {
  char metric[32];          /* "axis_error", … */
  char unit[8];             /* of the next three: "deg", "mm", "mm3", "ratio" */
  double value, full, zero; /* found (NaN: not measured); where all points and where none are given */
  double weight, points;
} OsteonScoreItem;

/* Measures the present bone and scores it by the plan's rubric; takes about 0.1 s, and the engine waits only
 * while the state is copied. The plan must be for this bone. Time, path and hand force are the caller's: they
 * have no score in the shipped rubric, and are not measured.
 * items: room for item_capacity rows of the score; null: none. item_count: receives how many the rubric has
 * (may be null where items is); OSTEON_ERROR_BUFFER where they do not fit. */
OSTEON_API OsteonResult osteon_session_assess(OsteonSession* session, const OsteonPlan* plan,
                                              OsteonAssessment* assessment, OsteonScoreItem* items,
                                              size_t item_capacity, size_t* item_count);

#ifdef __cplusplus
}
#endif
