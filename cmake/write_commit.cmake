# cmake -DSOURCE_DIR=... -DOUTPUT=... -P write_commit.cmake
# Writes the short git hash to the file OUTPUT; leaves the file alone when it has not changed. A copy of the sources
# without history takes it from the environment variable SCREE_COMMIT.
cmake_policy(VERSION 3.25)
set(SCREE_COMMIT unknown)
if("$ENV{SCREE_COMMIT}" MATCHES "^[0-9a-f]+$")
  set(SCREE_COMMIT "$ENV{SCREE_COMMIT}")
endif()
if(EXISTS "${SOURCE_DIR}/.git")
  execute_process(COMMAND git -C "${SOURCE_DIR}" rev-parse --short HEAD
    OUTPUT_VARIABLE hash OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
  if(status EQUAL 0 AND hash MATCHES "^[0-9a-f]+$")
    set(SCREE_COMMIT "${hash}")
  endif()
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" @ONLY CONTENT "#define SCREE_COMMIT \"@SCREE_COMMIT@\"\n")
