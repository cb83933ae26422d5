# Target coverage: runs the tests of the C code, then tells how many of its branches they took.
file(GLOB tests CONFIGURE_DEPENDS tests/test_c_*.py tests/test_fmi_*.py)
list(FILTER tests EXCLUDE REGEX "stress") # compiles programs of its own
list(APPEND tests tests/test_antagonistic.py tests/test_noise.py tests/test_plant.py
     tests/test_plant_radau.py)
set(remove_counts "import pathlib, sys; "
                  "[path.unlink() for path in pathlib.Path(sys.argv[1]).rglob('*.gcda')]")
string(JOIN "" remove_counts ${remove_counts})
add_custom_target(
  coverage
  COMMAND ${SIGMAHAT_PYTHON} -c ${remove_counts} ${PROJECT_BINARY_DIR} # of an earlier run
  COMMAND
    ${CMAKE_COMMAND} -E env SIGMAHAT_BUILD=${PROJECT_BINARY_DIR}
    ${SIGMAHAT_PYTHON} -m pytest -q -n auto --dist loadscope -m "not slow" ${tests}
  COMMAND
    ${SIGMAHAT_PYTHON} -m gcovr --object-directory ${PROJECT_BINARY_DIR} --filter c/
    --filter fmu_src/ --txt - --txt-metric branch --print-summary --fail-under-branch 95
    ${PROJECT_BINARY_DIR}
  WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
  USES_TERMINAL VERBATIM)
add_dependencies(coverage sigmahat_test_driver)
