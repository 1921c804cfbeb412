# tape_test_suites(PROGRAM): one ctest entry per suite of a GoogleTest program, listed when ctest starts: no build step,
# and one process per suite instead of one per test. What the name of a suite says:
#   Long...   label `long`: not in `make test`, only in `make check-all`
function(tape_test_suites program)
  set(file ${CMAKE_CURRENT_BINARY_DIR}/${program}_suites.cmake)
  file(GENERATE OUTPUT ${file} CONTENT "set(PROGRAM \"$<TARGET_FILE:${program}>\")\nset(LSAN \"${PROJECT_SOURCE_DIR}/cmake/lsan.txt\")\ninclude(\"${PROJECT_SOURCE_DIR}/cmake/list_suites.cmake\")\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${file})
endfunction()
