/* Reams the shipped acetabulum for five seconds of its own time, and prints what the hand would feel. Exits
 * with 1 where a call fails. Units: SI; see osteon.h.
 *
 *     cc -std=c11 ream_cup.c $(pkg-config --cflags --libs osteon) -lm -o ream_cup && ./ream_cup bone.stl */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <osteon.h>

static void check(OsteonResult result) {
  if (result >= OSTEON_OK) return;
  fprintf(stderr, "%s: %s\n", osteon_result_text(result), osteon_last_error());
  exit(1);
}

int main(int argc, char** argv) {
  OsteonBoneParams bone_params;
  OsteonToolParams tool_params;
  OsteonSettings settings;
  OsteonBone* bone = NULL;
  OsteonTool* tool = NULL;
  OsteonSession* session = NULL;
  OsteonBoneInfo info;
  osteon_bone_params_default(&bone_params); /* the scene "acetabulum" */
  osteon_tool_params_default(&tool_params); /* the reamer of 50 mm */
  osteon_settings_default(&settings);
  settings.lockstep = 1; /* frame by frame: the same output in every run */
  check(osteon_bone_create(OSTEON_ABI, &bone_params, &bone));
  check(osteon_tool_create(OSTEON_ABI, &tool_params, &tool));
  check(osteon_session_create(OSTEON_ABI, bone, tool, &settings, &session));
  check(osteon_bone_info(bone, &info));
  printf("%s; %llu balls\n", osteon_session_engine(session), (unsigned long long)info.balls);

  const double spindle = osteon_tool_spindle_rad_per_s(tool);
  OsteonFigures figures;
  for (int ms = 0; ms <= 5000; ++ms) {
    OsteonPose pose;
    OsteonWrench wrench;
    check(osteon_bone_approach(bone, -0.017 - 0.002e-3 * ms, &pose)); /* the hand feeds 2 mm/s along the axis */
    check(osteon_session_step(session, &pose, spindle, 0.001));
    check(osteon_session_evaluate(session, &pose, NULL, &wrench));
    if (ms % 500 != 0) continue;
    check(osteon_session_figures(session, &figures));
    const double* f = wrench.force_N;
    printf("%4.1f s  force %6.1f N  removed %7.1f mm3\n", 1e-3 * ms, sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]),
           1e9 * figures.removed_volume_m3);
  }
  if (argc > 1) {
    OsteonSurfaceInfo surface;
    check(osteon_session_surface_export(session, argv[1], &surface));
    printf("%s: %llu triangles\n", argv[1], (unsigned long long)surface.triangles);
  }
  osteon_session_destroy(session);
  osteon_tool_destroy(tool);
  osteon_bone_destroy(bone);
  return 0;
}
