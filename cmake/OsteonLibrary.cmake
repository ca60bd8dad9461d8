# osteon_library(NAME SOURCES a.cpp … HEADERS a.h … [PRIVATE_HEADERS b.h …] [LINK osteon::x …] [PRIVATE yaml-cpp …]
#                [PRECOMPILED holder])
# Adds a folder's static library, with the alias osteon::NAME. HEADERS are included by other folders and use only the
# libraries of LINK. PRIVATE_HEADERS are internal and may use those of PRIVATE. The test architecture.Tree.headers shows
# that each compiles alone. PRECOMPILED names other precompiled headers than the usual ones.
#
# Sources between two "|" are compiled as one file (osteon_together): names in their unnamed namespaces must differ.
set(OSTEON_LISTED_HEADERS ${CMAKE_BINARY_DIR}/listed_headers.txt)
file(WRITE ${OSTEON_LISTED_HEADERS} "")  # their names, one a line

# osteon_together(TARGET a.cpp b.cpp | c.cpp …): adds sources; each group between "|" is compiled as one file if
# OSTEON_TOGETHER is ON. Most of a file's compile time goes into its headers' templates, compiled once per group.
function(osteon_together TARGET)
  set(group 0)
  foreach(source ${ARGN})
    if(source STREQUAL "|")
      math(EXPR group "${group} + 1")
    else()
      target_sources(${TARGET} PRIVATE ${source})
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${TARGET}_${group})
    endif()
  endforeach()
  set_target_properties(${TARGET} PROPERTIES UNITY_BUILD "${OSTEON_TOGETHER}" UNITY_BUILD_MODE GROUP)
endfunction()

# osteon_precompile(TARGET HOLDER): TARGET's sources find the headers of HOLDER (osteon_precompiled_headers) already
# parsed. No difference if OSTEON_PRECOMPILE is OFF.
function(osteon_precompile TARGET HOLDER)
  if(OSTEON_PRECOMPILE)
    target_precompile_headers(${TARGET} REUSE_FROM ${HOLDER})
  endif()
endfunction()

# osteon_precompiled_headers(HOLDER HEADERS <a> … LINK x … OPTIONS -f…): parses system headers once for many targets.
# GCC uses the result only where all options and every macro that these headers name are the same: OPTIONS makes them so.
function(osteon_precompiled_headers HOLDER)
  cmake_parse_arguments(ARG "" "" "HEADERS;LINK;OPTIONS" ${ARGN})
  if(OSTEON_PRECOMPILE)
    set(source ${CMAKE_CURRENT_BINARY_DIR}/${HOLDER}.cpp)  # a target with precompiled headers needs a source
    file(CONFIGURE OUTPUT ${source} CONTENT "" @ONLY)
    add_library(${HOLDER} OBJECT EXCLUDE_FROM_ALL ${source})
    target_link_libraries(${HOLDER} PRIVATE osteon::options ${ARG_LINK})
    target_compile_options(${HOLDER} PRIVATE ${ARG_OPTIONS})
    target_precompile_headers(${HOLDER} PRIVATE ${ARG_HEADERS})
  endif()
endfunction()

# What most sources include. They are parsed three times: for the folders of the tick, for those around the loop, which
# both have options of their own, and for the others.
set(OSTEON_COMMON_HEADERS <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <memory> <numbers> <optional>
  <span> <string> <variant> <vector> <Eigen/Geometry>)

# osteon_list_headers(a.h …): lists headers of the calling folder for the test architecture.Tree.headers.
function(osteon_list_headers)
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE folder)
  foreach(header ${ARGN})
    file(APPEND ${OSTEON_LISTED_HEADERS} "${folder}/${header}\n")
  endforeach()
endfunction()

function(osteon_library NAME)
  cmake_parse_arguments(ARG "" "PRECOMPILED" "SOURCES;HEADERS;PRIVATE_HEADERS;LINK;PRIVATE" ${ARGN})
  if(ARG_SOURCES)
    add_library(osteon_${NAME} STATIC)
    osteon_together(osteon_${NAME} ${ARG_SOURCES})
    target_link_libraries(osteon_${NAME} PUBLIC osteon::options ${ARG_LINK} PRIVATE ${ARG_PRIVATE})
    set(scope PUBLIC)
    get_directory_property(own_options COMPILE_OPTIONS)
    if(ARG_PRECOMPILED)
      osteon_precompile(osteon_${NAME} ${ARG_PRECOMPILED})
    elseif(NOT own_options)
      osteon_precompile(osteon_${NAME} osteon_library_headers)
    elseif(own_options STREQUAL OSTEON_TICK_OPTIONS)
      osteon_precompile(osteon_${NAME} osteon_tick_headers)
    elseif(own_options STREQUAL OSTEON_OUTER_OPTIONS)
      osteon_precompile(osteon_${NAME} osteon_outer_headers)
    endif()
  else()
    add_library(osteon_${NAME} INTERFACE)
    target_link_libraries(osteon_${NAME} INTERFACE osteon::options ${ARG_LINK})
    set(scope INTERFACE)
  endif()
  add_library(osteon::${NAME} ALIAS osteon_${NAME})
  target_sources(osteon_${NAME} ${scope} FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${ARG_HEADERS})
  osteon_list_headers(${ARG_HEADERS} ${ARG_PRIVATE_HEADERS})
endfunction()

# osteon_tick_first(TARGET): TARGET's tick runs the inline functions and templates that the tick's folders compiled. Of the
# equal ones that several sources have, the linker keeps the first, so that those of sources with lesser optimisation,
# which may call more, must come later.
function(osteon_tick_first TARGET)
  set(archives)
  foreach(library control kinematics safety guard cpu_engine io_net io_can io_fri io_rsi io_devices)
    list(APPEND archives $<TARGET_FILE:osteon_${library}>)
  endforeach()
  target_link_options(${TARGET} PRIVATE -Wl,--whole-archive ${archives} -Wl,--no-whole-archive)
endfunction()
