# Which commit is this? Asked at every build, so that a report never names an old one.
#
# Included, it makes the library rilievo_commit with `rilievo::commit()` of apps/commit.h; run as a
# script (cmake -D OUT=... -D SOURCE=... -P), it writes that function, if it has changed.

if(CMAKE_SCRIPT_MODE_FILE)
  cmake_minimum_required(VERSION 3.25)
  execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12
                  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET
                  RESULT_VARIABLE failed)
  if(failed OR commit STREQUAL "")
    set(commit "unknown")
  endif()
  file(CONFIGURE OUTPUT ${OUT} @ONLY CONTENT
"#include \"apps/commit.h\"

const char* rilievo::commit() { return \"@commit@\"; }
")
  return()
endif()

set(commit_source ${PROJECT_BINARY_DIR}/generated/commit.cpp)
add_custom_target(rilievo_commit_text
  COMMAND ${CMAKE_COMMAND} -D OUT=${commit_source} -D SOURCE=${PROJECT_SOURCE_DIR}
          -P ${CMAKE_CURRENT_LIST_FILE}
  BYPRODUCTS ${commit_source} VERBATIM)
add_library(rilievo_commit STATIC ${commit_source})
target_include_directories(rilievo_commit PUBLIC ${PROJECT_SOURCE_DIR})
add_dependencies(rilievo_commit rilievo_commit_text)
