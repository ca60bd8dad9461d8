# osteon_library(NAME SOURCES a.cpp … HEADERS a.h … [PRIVATE_HEADERS b.h …] [LINK osteon::x …] [PRIVATE yaml-cpp …]
#                [PRECOMPILED holder])
# Adds a folder's static library, with the alias osteon::NAME. HEADERS are included by other folders and use only the
# libraries of LINK. PRIVATE_HEADERS are internal and may use those of PRIVATE. The target osteon_verify_headers shows
# that each compiles alone (osteon_verify_headers()). PRECOMPILED names other precompiled headers than the usual ones.
#
# Sources between two "|" are compiled as one file (osteon_together): names in their unnamed namespaces must differ.
add_custom_target(osteon_verify_headers)
file(WRITE ${CMAKE_BINARY_DIR}/verified_headers.txt "")  # their names, one a line

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

# osteon_included(HEADER RESULT): HEADER (from the root) and all that it includes, as the #include lines name it.
function(osteon_included HEADER RESULT)
  get_property(included GLOBAL PROPERTY osteon_included_${HEADER})
  if(NOT included)
    set(included ${HEADER})
    file(STRINGS ${PROJECT_SOURCE_DIR}/${HEADER} lines REGEX "^ *# *include ")
    foreach(line ${lines})
      if(NOT line MATCHES "include +[<\"]([^>\"]+)[>\"]")
        continue()
      endif()
      set(name ${CMAKE_MATCH_1})
      if(EXISTS ${PROJECT_SOURCE_DIR}/${name})
        osteon_included(${name} more)
        list(APPEND included ${more})
      else()
        list(APPEND included <${name}>)
      endif()
    endforeach()
    list(REMOVE_DUPLICATES included)
    set_property(GLOBAL PROPERTY osteon_included_${HEADER} ${included})
  endif()
  set(${RESULT} ${included} PARENT_SCOPE)
endfunction()

# What osteon_verify_headers() finds parsed: sets of headers that many others include, the largest first.
set(OSTEON_VERIFY_SETS commands command cell tick scene spatial files string)
set(OSTEON_VERIFY_commands <CLI/CLI.hpp> config/reading/cell_config.h)
set(OSTEON_VERIFY_command <CLI/CLI.hpp>)
set(OSTEON_VERIFY_cell config/reading/cell_config.h)
set(OSTEON_VERIFY_tick control/tick_record.h)
set(OSTEON_VERIFY_scene kinematics/spatial.h <filesystem>)
set(OSTEON_VERIFY_spatial kinematics/spatial.h)
set(OSTEON_VERIFY_files <filesystem>)
set(OSTEON_VERIFY_string <string>)

# osteon_verify_sets(): the targets that parse those sets. Called once, before the libraries.
function(osteon_verify_sets)
  foreach(set ${OSTEON_VERIFY_SETS})
    set(headers ${OSTEON_VERIFY_${set}})
    set(libraries Eigen3::Eigen)
    foreach(header ${headers})
      if(header MATCHES "^([a-z]+)/")  # one of ours needs its folder's library
        list(APPEND libraries osteon::${CMAKE_MATCH_1})
      endif()
    endforeach()
    list(TRANSFORM headers PREPEND ${PROJECT_SOURCE_DIR}/ REGEX "^[^<]")
    osteon_precompiled_headers(osteon_verify_${set} HEADERS ${headers} LINK ${libraries} OPTIONS -O0)
  endforeach()
endfunction()

# osteon_verify_set(HEADER RESULT): the first set of which HEADER includes all; without one "plain".
function(osteon_verify_set HEADER RESULT)
  set(${RESULT} plain PARENT_SCOPE)
  osteon_included(${HEADER} included)
  foreach(set ${OSTEON_VERIFY_SETS})
    set(missing ${OSTEON_VERIFY_${set}})
    list(REMOVE_ITEM missing ${included})
    if(OSTEON_PRECOMPILE AND NOT missing)
      set(${RESULT} ${set} PARENT_SCOPE)
      return()
    endif()
  endforeach()
endfunction()

# osteon_verify_headers(TARGET LIBRARIES a.h …): the targets TARGET_<set> compile the headers with LIBRARIES so that one
# which does not compile alone is found. Most of such a compilation is Eigen and the standard library, so several
# headers share one file where this hides nothing: a header may stand behind another that it includes itself, for
# everything that is declared before it, it includes as well. In the same way a header may find a set of headers parsed
# that it includes. (A header that needs what it does not include, but includes a header that needs it as well, is no
# exception: there the included one is found.) This holds as long as all #include lines stand before the code. The
# headers of a file are of one set, else a later one would parse what it could find parsed.
#
# The compiler checks only (-fsyntax-only) and writes no object; check_only.sh leaves an empty one for the build.
set(OSTEON_CHECK_ONLY ${CMAKE_CURRENT_LIST_DIR}/check_only.sh)
function(osteon_verify_headers TARGET LIBRARIES)
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE folder)
  set(sorted)  # by the number of files included: "0012 folder/a.h"
  foreach(header ${ARGN})
    osteon_included(${folder}/${header} included)
    list(LENGTH included length)
    math(EXPR length "10000 + ${length}")
    list(APPEND sorted "${length} ${folder}/${header}")
    file(APPEND ${CMAKE_BINARY_DIR}/verified_headers.txt "${folder}/${header}\n")
  endforeach()
  list(SORT sorted)

  # files_<set>: each is named by its first header; last_<file> is its last entry of `sorted`, text_<file> its content
  foreach(entry ${sorted})
    string(SUBSTRING ${entry} 6 -1 header)
    osteon_included(${header} included)
    osteon_verify_set(${header} set)
    set(chosen ${header})
    set(last "")
    foreach(file ${files_${set}})
      string(SUBSTRING ${last_${file}} 6 -1 last_header)
      if(last_header IN_LIST included AND last_${file} STRGREATER last)
        set(chosen ${file})
        set(last ${last_${file}})
      endif()
    endforeach()
    if(chosen STREQUAL header)
      list(APPEND files_${set} ${header})
      set(text_${header} "")
    endif()
    set(last_${chosen} ${entry})
    string(APPEND text_${chosen} "#include \"${header}\"\n")
  endforeach()

  foreach(set plain ${OSTEON_VERIFY_SETS})
    set(sources)
    foreach(file ${files_${set}})
      set(source ${CMAKE_CURRENT_BINARY_DIR}/${TARGET}/${file}.cxx)
      file(CONFIGURE OUTPUT ${source} CONTENT "${text_${file}}" @ONLY)
      list(APPEND sources ${source})
    endforeach()
    if(sources)
      add_library(${TARGET}_${set} OBJECT EXCLUDE_FROM_ALL ${sources})
      target_link_libraries(${TARGET}_${set} PRIVATE osteon::options ${LIBRARIES})
      # not the folder's own: GCC takes what is precompiled only where all options are the same; nothing of it runs
      set_target_properties(${TARGET}_${set} PROPERTIES COMPILE_OPTIONS "-O0;-fsyntax-only"
        CXX_COMPILER_LAUNCHER ${OSTEON_CHECK_ONLY})
      add_dependencies(osteon_verify_headers ${TARGET}_${set})
      if(NOT set STREQUAL plain)
        osteon_precompile(${TARGET}_${set} osteon_verify_${set})
      endif()
    endif()
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

  osteon_verify_headers(osteon_${NAME}_verify_headers osteon_${NAME} ${ARG_HEADERS})
  osteon_verify_headers(osteon_${NAME}_verify_private_headers "osteon_${NAME};${ARG_PRIVATE}" ${ARG_PRIVATE_HEADERS})
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
