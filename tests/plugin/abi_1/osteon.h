// The interface as OSTEON_ABI 1 began, without its comments: abi_test.sh compiles programs with it. Never
// edit it: a library of ABI 1 has to serve them, a later one has to refuse them.
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define OSTEON_VERSION "0.1.0"

#define OSTEON_ABI 1u

#if defined(__GNUC__)
#define OSTEON_API __attribute__((visibility("default")))
#else
#define OSTEON_API
#endif

typedef enum OsteonResult {
  OSTEON_OK = 0,
  OSTEON_EMPTY = 1,
  OSTEON_ERROR_ARGUMENT = -1,
  OSTEON_ERROR_FILE = -2,
  OSTEON_ERROR_MEMORY = -3,
  OSTEON_ERROR_DEVICE = -4,
  OSTEON_ERROR_STATE = -5,
  OSTEON_ERROR_ABI = -6,
  OSTEON_ERROR_FORK = -7,
  OSTEON_ERROR_BUFFER = -8,
  OSTEON_ERROR_INTERNAL = -9
} OsteonResult;

typedef enum OsteonEngine {
  OSTEON_ENGINE_AUTO = 0,
  OSTEON_ENGINE_CPU = 1,
  OSTEON_ENGINE_VULKAN = 2
} OsteonEngine;

typedef struct OsteonPose {
  double position_m[3];
  double orientation_wxyz[4];
} OsteonPose;

typedef struct OsteonTwist {
  double linear_m_per_s[3];
  double angular_rad_per_s[3];
} OsteonTwist;

typedef struct OsteonWrench {
  double force_N[3];
  double torque_Nm[3];
} OsteonWrench;

typedef struct OsteonBone OsteonBone;
typedef struct OsteonTool OsteonTool;
typedef struct OsteonSession OsteonSession;

OSTEON_API const char* osteon_version(void);

OSTEON_API uint32_t osteon_abi(void);

OSTEON_API const char* osteon_result_text(OsteonResult result);

OSTEON_API const char* osteon_last_error(void);

typedef struct OsteonBoneParams {
  const char* scene;
  const char* mesh_file;
  double mesh_scale_mm;
  const char* packing_file;
  const float* balls_mm;
  size_t ball_count;
  const char* material;
  double site_center_m[3];
  double site_axis[3];
  double site_radius_m;
  const char* config_folder;
} OsteonBoneParams;

OSTEON_API void osteon_bone_params_default(OsteonBoneParams* params);

OSTEON_API OsteonResult osteon_bone_create(uint32_t abi, const OsteonBoneParams* params, OsteonBone** bone);

OSTEON_API void osteon_bone_destroy(OsteonBone* bone);

typedef struct OsteonBoneInfo {
  uint64_t balls;
  uint64_t mass_points;
  double volume_m3;
  double mass_kg;
  double site_center_m[3];
  double site_axis[3];
  double site_radius_m;
  uint32_t material_count;
} OsteonBoneInfo;

OSTEON_API OsteonResult osteon_bone_info(const OsteonBone* bone, OsteonBoneInfo* info);

OSTEON_API const char* osteon_bone_material(const OsteonBone* bone, uint32_t index);

OSTEON_API OsteonResult osteon_bone_approach(const OsteonBone* bone, double height_m, OsteonPose* pose);

typedef struct OsteonToolParams {
  const char* name;
  double diameter_m;
  const float* balls_mm;
  const uint8_t* cutting;
  size_t ball_count;
  const char* config_folder;
} OsteonToolParams;

OSTEON_API void osteon_tool_params_default(OsteonToolParams* params);
OSTEON_API OsteonResult osteon_tool_create(uint32_t abi, const OsteonToolParams* params, OsteonTool** tool);
OSTEON_API void osteon_tool_destroy(OsteonTool* tool);

OSTEON_API double osteon_tool_spindle_rad_per_s(const OsteonTool* tool);

typedef struct OsteonSettings {
  uint32_t engine;
  const char* device;
  uint32_t lockstep;
  uint32_t surface;
  double max_force_N;
  double max_torque_Nm;
  double stiffness_N_per_m;
  double damping_Ns_per_m;
} OsteonSettings;

OSTEON_API void osteon_settings_default(OsteonSettings* settings);

OSTEON_API OsteonResult osteon_session_create(uint32_t abi, const OsteonBone* bone, const OsteonTool* tool,
                                              const OsteonSettings* settings, OsteonSession** session);

OSTEON_API void osteon_session_destroy(OsteonSession* session);

OSTEON_API const char* osteon_session_engine(const OsteonSession* session);

OSTEON_API OsteonResult osteon_session_set_tool_pose(OsteonSession* session, const OsteonPose* pose,
                                                     double spindle_rad_per_s);

OSTEON_API OsteonResult osteon_session_step(OsteonSession* session, const OsteonPose* pose,
                                            double spindle_rad_per_s, double dt_s);

OSTEON_API OsteonResult osteon_session_evaluate(OsteonSession* session, const OsteonPose* pose,
                                                const OsteonTwist* twist, OsteonWrench* wrench);

typedef struct OsteonFigures {
  uint64_t frame;
  double pose_age_s;
  double frame_time_s;
  OsteonPose proxy;
  OsteonWrench wrench;
  double removed_volume_m3;
  double removed_mass_kg;
  double cutting_work_J;
  double spindle_torque_Nm;
  double engaged_area_m2;
  double depth_m;
  uint32_t contacts;
  uint32_t reserved;
  uint64_t skipped_on_surface;
} OsteonFigures;

OSTEON_API OsteonResult osteon_session_figures(OsteonSession* session, OsteonFigures* figures);

typedef struct OsteonEvent {
  char name[48];
  double value_m;
  double position_m[3];
  uint64_t frame;
} OsteonEvent;

OSTEON_API OsteonResult osteon_session_next_event(OsteonSession* session, OsteonEvent* event);

OSTEON_API OsteonResult osteon_session_change_tool(OsteonSession* session, const OsteonTool* tool,
                                                   const OsteonPose* pose);

OSTEON_API OsteonResult osteon_session_mark(OsteonSession* session);

OSTEON_API OsteonResult osteon_session_undo(OsteonSession* session, const OsteonPose* pose);

OSTEON_API OsteonResult osteon_session_save(OsteonSession* session, const char* file);

OSTEON_API OsteonResult osteon_session_restore(OsteonSession* session, const char* file,
                                               const OsteonPose* pose);

typedef struct OsteonVertex {
  float position_mm[3];
  float normal[3];
  uint8_t material;
  uint8_t cut;
  uint8_t reserved[2];
} OsteonVertex;

typedef struct OsteonChunk {
  uint32_t brick;
  uint32_t first_vertex, vertex_count;
  uint32_t first_index, index_count;
  uint32_t reserved;
} OsteonChunk;

#define OSTEON_CHUNK_MAX_VERTICES 5832u
#define OSTEON_CHUNK_MAX_INDICES 9216u

typedef struct OsteonSurfaceBuffers {
  OsteonChunk* chunks;
  OsteonVertex* vertices;
  uint16_t* indices;
  size_t chunk_capacity, vertex_capacity, index_capacity;
  size_t chunk_count, vertex_count, index_count;
  uint64_t left;
} OsteonSurfaceBuffers;

OSTEON_API OsteonResult osteon_session_surface_changes(OsteonSession* session, uint64_t* generation,
                                                       OsteonSurfaceBuffers* buffers);

OSTEON_API OsteonResult osteon_session_surface_wait(OsteonSession* session);

typedef struct OsteonSurfaceInfo {
  uint64_t triangles;
  double volume_m3;
  uint32_t watertight;
  uint32_t reserved;
} OsteonSurfaceInfo;

OSTEON_API OsteonResult osteon_session_surface_export(OsteonSession* session, const char* file,
                                                      OsteonSurfaceInfo* info);

#ifdef __cplusplus
}
#endif
