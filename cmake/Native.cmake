# The C library of the Python package runs the estimator over samples and over arrays. Python calls this
# library with ctypes, so it depends on the platform, but not on the version of Python.
add_library(sigmahat_native MODULE harness/native/sample_loop.c harness/native/joints.c
            harness/native/saved_joints.c
            ${PROJECT_BINARY_DIR}/fmu/StiffnessEstimator/variables.h)
get_target_property(library_folders sigmahat_c INCLUDE_DIRECTORIES)
set(SIGMAHAT_NATIVE_INCLUDES ${PROJECT_BINARY_DIR}/fmu/StiffnessEstimator
                             ${PROJECT_SOURCE_DIR}/fmu_src ${PROJECT_SOURCE_DIR}/c/include
                             ${library_folders})
target_include_directories(sigmahat_native PRIVATE ${SIGMAHAT_NATIVE_INCLUDES})
target_include_directories(sigmahat_native SYSTEM PRIVATE ${SIGMAHAT_FMI_HEADERS})
target_link_libraries(sigmahat_native PRIVATE sigmahat_c)
set_target_properties(sigmahat_native PROPERTIES PREFIX "" C_VISIBILITY_PRESET hidden
                                                 LIBRARY_OUTPUT_DIRECTORY ${SIGMAHAT_FMU_FOLDER})
if(APPLE)
  set_target_properties(sigmahat_native PROPERTIES SUFFIX ".dylib")
endif()
add_dependencies(sigmahat_native StiffnessEstimator)
