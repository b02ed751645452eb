# Read by ctest: adds a test per suite of cases of a program of GoogleTest, named <name>.<suite>, or one per case of the
# suites that match `apart`. Most cases take less time than their process takes to start.
#   name, program   name of the tests and what they run
#   launcher        a command (a list) to put before it
#   apart           regular expression: suites that take long, whose cases run beside each other
#   properties      of the tests
if(NOT EXISTS "${program}")
  add_test("${name}_NOT_BUILT" "${program}")
  return()
endif()
execute_process(COMMAND "${program}" --gtest_list_tests TIMEOUT 120 OUTPUT_VARIABLE cases RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${program} lists no cases (${result}):\n${cases}")
endif()
# Lines that name a suite begin with its name and end with a point, those of its cases are indented; values follow a #.
string(REGEX REPLACE "[][;]" "_" cases "${cases}")
string(REPLACE "\n" ";" cases "${cases}")
foreach(line IN LISTS cases)
  if(line MATCHES "^([^ ]+)\\.( *# TypeParam = (.*))?$")
    set(suite "${CMAKE_MATCH_1}")
    set(shown "${suite}")
    if(CMAKE_MATCH_3)
      string(REGEX REPLACE "/[0-9]+$" "<${CMAKE_MATCH_3}>" shown "${suite}")
    endif()
    set(filter "*")
    if(suite MATCHES "${apart}")
      continue()
    endif()
  elseif(suite MATCHES "${apart}" AND line MATCHES "^  ([^ ]+)")
    set(filter "${CMAKE_MATCH_1}")
  else()
    continue()
  endif()
  set(test "${name}.${shown}")
  if(NOT filter STREQUAL "*")
    string(APPEND test ".${filter}")
  endif()
  add_test("${test}" ${launcher} "${program}" "--gtest_filter=${suite}.${filter}")
  # Skipped is what skipped all of its cases; one that failed beside them would be named in further lines.
  set_tests_properties("${test}" PROPERTIES SKIP_REGULAR_EXPRESSION
    "\\[  PASSED  \\] 0 tests\\.\n(\\[  SKIPPED \\] [^\n]*\n)+\n*$" ${properties})
endforeach()
