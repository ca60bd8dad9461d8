# Writes OUT, the header with the commit of SOURCE that is built, if its content changes.
execute_process(COMMAND git -c safe.directory=* -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed ERROR_QUIET)
if(failed)
  set(commit "unknown")
endif()
set(text "#pragma once\n\nnamespace osteon::session {\ninline constexpr char kCommit[] = \"${commit}\";\n}\n")
if(EXISTS ${OUT})
  file(READ ${OUT} present)
endif()
if(NOT "${present}" STREQUAL "${text}")
  file(WRITE ${OUT} "${text}")
endif()
