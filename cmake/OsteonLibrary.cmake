# osteon_library(NAME SOURCES a.cpp … HEADERS a.h … [LINK osteon::x …] [PRIVATE yaml-cpp …])
# A static library of one folder, with the alias osteon::NAME. Its headers form a header set, so that the target
# <name>_verify_interface_header_sets (all of them: all_verify_interface_header_sets) compiles each header alone.
set(CMAKE_VERIFY_INTERFACE_HEADER_SETS ON)

function(osteon_library NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;HEADERS;LINK;PRIVATE" ${ARGN})
  if(ARG_SOURCES)
    add_library(osteon_${NAME} STATIC ${ARG_SOURCES})
    target_link_libraries(osteon_${NAME} PUBLIC osteon::options ${ARG_LINK} PRIVATE ${ARG_PRIVATE})
    set(scope PUBLIC)
  else()
    add_library(osteon_${NAME} INTERFACE)
    target_link_libraries(osteon_${NAME} INTERFACE osteon::options ${ARG_LINK})
    set(scope INTERFACE)
  endif()
  add_library(osteon::${NAME} ALIAS osteon_${NAME})
  target_sources(osteon_${NAME} ${scope} FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${ARG_HEADERS})
endfunction()
