# cmake -DSOURCE_DIR=... -DOUTPUT=... -P write_commit.cmake
# Writes the short git hash to the file OUTPUT; leaves the file alone when it has not changed. Copies of the sources with
# no history, or an older one, are told theirs by the environment variable SCREE_COMMIT.
cmake_policy(VERSION 3.25)
set(SCREE_COMMIT unknown)
if(EXISTS "${SOURCE_DIR}/.git")
  execute_process(COMMAND git -C "${SOURCE_DIR}" rev-parse --short HEAD
    OUTPUT_VARIABLE hash OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
  if(status EQUAL 0 AND hash MATCHES "^[0-9a-f]+$")
    set(SCREE_COMMIT "${hash}")
  endif()
endif()
if("$ENV{SCREE_COMMIT}" MATCHES "^[0-9a-f]+$")
  set(SCREE_COMMIT "$ENV{SCREE_COMMIT}")
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" @ONLY CONTENT "#define SCREE_COMMIT \"@SCREE_COMMIT@\"\n")
