/* unload_test LIBRARY CONFIG: loads libosteon.so, cuts for a moment in a session with threads of its own,
 * destroys it and unloads the library, twice in one process, as an editor that reloads its plug-ins.
 * Then it exports a large surface and unloads the library, of which the mesh library leaves an idle thread
 * behind. Exit code 1: a call fails, a thread or the library stays, or the second time differs from the
 * first. The program itself is not linked to Osteon. */
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <osteon.h>

static void fail(const char* what, const char* text) {
  fprintf(stderr, "unload_test: %s: %s\n", what, text);
  exit(1);
}

static int thread_count(void) {
  int count = 0;
  DIR* tasks = opendir("/proc/self/task");
  if (!tasks) fail("/proc/self/task", "cannot be read");
  for (struct dirent* each; (each = readdir(tasks)) != NULL;) count += each->d_name[0] != '.';
  closedir(tasks);
  return count;
}

static int is_mapped(const char* name) {
  char line[4096];
  int found = 0;
  FILE* maps = fopen("/proc/self/maps", "r");
  if (!maps) fail("/proc/self/maps", "cannot be read");
  while (fgets(line, sizeof line, maps) != NULL) found = found || strstr(line, name) != NULL;
  fclose(maps);
  return found;
}

static void sleep_ms(long ms) {
  const struct timespec time = {.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000L};
  nanosleep(&time, NULL);
}

/* A function of the library, by its name and osteon.h's type. */
#define FUNCTION(NAME)                         \
  __typeof__(&NAME) NAME##_;                   \
  *(void**)(&NAME##_) = dlsym(library, #NAME); \
  if (!NAME##_) fail(#NAME, dlerror())
#define CHECK(CALL) \
  if ((CALL) < OSTEON_OK) fail(#CALL, osteon_last_error_())

static void load_cut_and_unload(const char* file, const char* config, double* removed_m3) {
  void* library = dlopen(file, RTLD_NOW | RTLD_LOCAL);
  if (!library) fail("dlopen", dlerror());
  FUNCTION(osteon_last_error);
  FUNCTION(osteon_bone_params_default);
  FUNCTION(osteon_bone_create);
  FUNCTION(osteon_bone_destroy);
  FUNCTION(osteon_tool_params_default);
  FUNCTION(osteon_tool_create);
  FUNCTION(osteon_tool_destroy);
  FUNCTION(osteon_settings_default);
  FUNCTION(osteon_session_create);
  FUNCTION(osteon_session_destroy);
  FUNCTION(osteon_session_set_tool_pose);
  FUNCTION(osteon_session_evaluate);
  FUNCTION(osteon_session_figures);
  FUNCTION(osteon_session_surface_wait);

  /* a bone of nine balls in a row, and a tool of one ball that cuts */
  float balls[4 * 9];
  for (int i = 0; i < 9; ++i)
    memcpy(balls + 4 * i, (float[]){(float)(i - 4), 0.0F, 0.0F, 1.0F}, 4 * sizeof(float));
  const float cutter[4] = {0.0F, 0.0F, 0.0F, 3.0F};
  OsteonBoneParams bone_params;
  OsteonToolParams tool_params;
  OsteonSettings settings;
  osteon_bone_params_default_(&bone_params);
  osteon_tool_params_default_(&tool_params);
  osteon_settings_default_(&settings);
  bone_params.balls_mm = balls, bone_params.ball_count = 9, bone_params.config_folder = config;
  bone_params.site_axis[2] = 1.0, bone_params.site_radius_m = 0.003;
  tool_params.balls_mm = cutter, tool_params.ball_count = 1;
  settings.engine = OSTEON_ENGINE_CPU; /* a GPU's driver may stay loaded */
  OsteonBone* bone = NULL;
  OsteonTool* tool = NULL;
  OsteonSession* session = NULL;
  CHECK(osteon_bone_create_(OSTEON_ABI, &bone_params, &bone));
  CHECK(osteon_tool_create_(OSTEON_ABI, &tool_params, &tool));
  CHECK(osteon_session_create_(OSTEON_ABI, bone, tool, &settings, &session));
  if (thread_count() < 3) fail("threads", "the session has none: accepted its engine's and its surface's");

  OsteonFigures figures;
  OsteonPose pose = {.orientation_wxyz = {1.0, 0.0, 0.0, 0.0}};
  for (int ms = 0; ms < 10000; ++ms) { /* until it has cut, also on a slow machine */
    OsteonWrench wrench;
    pose.position_m[2] = 4.2e-3 - (ms < 600 ? ms : 600) * 5e-6;
    CHECK(osteon_session_set_tool_pose_(session, &pose, 100.0));
    CHECK(osteon_session_evaluate_(session, &pose, NULL, &wrench));
    CHECK(osteon_session_figures_(session, &figures));
    if (figures.removed_volume_m3 > 0.0) break;
    sleep_ms(1);
  }
  CHECK(osteon_session_surface_wait_(session));
  *removed_m3 = figures.removed_volume_m3;
  osteon_session_destroy_(session);
  osteon_tool_destroy_(tool);
  osteon_bone_destroy_(bone);
  if (dlclose(library) != 0) fail("dlclose", dlerror());
}

/* The scene's whole surface, 280 000 triangles: Embree starts a thread of its pool for them, which stays. */
static void export_and_unload(const char* file, const char* config) {
  void* library = dlopen(file, RTLD_NOW | RTLD_LOCAL);
  if (!library) fail("dlopen", dlerror());
  FUNCTION(osteon_last_error);
  FUNCTION(osteon_bone_params_init);
  FUNCTION(osteon_bone_create);
  FUNCTION(osteon_bone_approach);
  FUNCTION(osteon_bone_destroy);
  FUNCTION(osteon_tool_params_init);
  FUNCTION(osteon_tool_create);
  FUNCTION(osteon_tool_destroy);
  FUNCTION(osteon_settings_init);
  FUNCTION(osteon_session_create);
  FUNCTION(osteon_session_destroy);
  FUNCTION(osteon_session_step);
  FUNCTION(osteon_session_surface_export);
  OsteonBoneParams bone_params;
  OsteonToolParams tool_params;
  OsteonSettings settings;
  CHECK(osteon_bone_params_init_(OSTEON_ABI, &bone_params));
  CHECK(osteon_tool_params_init_(OSTEON_ABI, &tool_params));
  CHECK(osteon_settings_init_(OSTEON_ABI, &settings));
  bone_params.config_folder = tool_params.config_folder = config;
  settings.engine = OSTEON_ENGINE_CPU, settings.lockstep = 1;
  OsteonBone* bone = NULL;
  OsteonTool* tool = NULL;
  OsteonSession* session = NULL;
  CHECK(osteon_bone_create_(OSTEON_ABI, &bone_params, &bone));
  CHECK(osteon_tool_create_(OSTEON_ABI, &tool_params, &tool));
  CHECK(osteon_session_create_(OSTEON_ABI, bone, tool, &settings, &session));
  OsteonPose pose;
  CHECK(osteon_bone_approach_(bone, 0.1, &pose));
  CHECK(osteon_session_step_(session, &pose, 0.0, 0.001));
  char surface[] = "unload_test_XXXXXX.stl";
  const int made = mkstemps(surface, 4);
  if (made < 0) fail(surface, "cannot be made here");
  close(made);
  CHECK(osteon_session_surface_export_(session, surface, NULL));
  unlink(surface);
  osteon_session_destroy_(session);
  osteon_tool_destroy_(tool);
  osteon_bone_destroy_(bone);
  if (dlclose(library) != 0) fail("dlclose", dlerror());
}

int main(int argc, char** argv) {
  if (argc != 3) fail("arguments", "accepted LIBRARY CONFIG");
  const char* name = strrchr(argv[1], '/') ? strrchr(argv[1], '/') + 1 : argv[1];
  for (int round = 1; round <= 2; ++round) {
    double removed_m3 = 0.0;
    load_cut_and_unload(argv[1], argv[2], &removed_m3);
    printf("round %d: removed %.1f mm3, threads %d, library %s\n", round, 1e9 * removed_m3, thread_count(),
           is_mapped(name) ? "mapped" : "gone");
    if (!(removed_m3 > 0.0)) fail("removed volume", "found 0, accepted above 0");
    if (thread_count() != 1) fail("threads", "found more than this one after destroy");
    if (is_mapped(name)) fail("the library", "found mapped after dlclose, accepted gone");
  }
  for (int round = 1; round <= 2; ++round) {
    export_and_unload(argv[1], argv[2]);
    sleep_ms(200); /* a thread whose code is gone ends the process when it wakes */
    printf("export %d: threads %d, library %s\n", round, thread_count(), is_mapped(name) ? "mapped" : "gone");
    if (thread_count() > 2) fail("threads", "found more than the mesh library's idle one after destroy");
    if (is_mapped(name)) fail("the library", "found mapped after dlclose, accepted gone");
  }
  return 0;
}
