# The target coverage runs the tests of the C code and prints the share of the branches that they execute.
sigmahat_add_packages(coverage)
file(GLOB tests CONFIGURE_DEPENDS tests/c/test_*.py tests/c/parts/test_*.py tests/fmi/test_*.py)
# The tests excluded here compile programs without coverage, run no C code, or need more packages.
list(FILTER tests EXCLUDE REGEX
     "controller|endurance|library_packages|model_description|mutation|sample_loop|stress")
file(GLOB promises CONFIGURE_DEPENDS tests/proof/test_promises_of_*.py)
list(APPEND tests ${promises} tests/plants/test_integration.py tests/plants/test_every_plant.py)
add_custom_target(
  coverage
  COMMAND ${run_tests} -q --dist loadscope -m "not slow" -k "not table1" ${tests}
  COMMAND
    ${SIGMAHAT_PYTHON} -m gcovr --object-directory ${PROJECT_BINARY_DIR} --filter c/
    --filter fmu_src/ --gcov-exclude-directories .*/CompilerIdC --txt - --txt-metric branch
    --print-summary --fail-under-branch 95 --delete ${PROJECT_BINARY_DIR}
  WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
  COMMENT "Tests of the C code, and the branches that they took" USES_TERMINAL VERBATIM)
add_dependencies(coverage sigmahat_test_driver StiffnessEstimator AntagonisticStiffnessEstimator
                 AwasPlant FlexibleJointPlant AntagonisticVsaPlant RealJointPlant awas_system
                 StiffnessEstimator_FMI3 AntagonisticStiffnessEstimator_FMI3 AwasPlant_FMI3
                 FlexibleJointPlant_FMI3 AntagonisticVsaPlant_FMI3 RealJointPlant_FMI3
                 packages_coverage)
