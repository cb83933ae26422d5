# The target live writes the page of docs/live to live/, with plant and estimator as WebAssembly. The
# target docs copies this page to the site. The plant is an FMU. The estimator is the library with the
# functions that the Python package calls.
set(live ${PROJECT_BINARY_DIR}/live)
set(live_fmus ${SIGMAHAT_FMU_FOLDER}/AwasPlant.fmu ${SIGMAHAT_FMU_FOLDER}/StiffnessEstimator.fmu)
get_target_property(library_sources sigmahat_c SOURCES)
set(live_sources ${PROJECT_SOURCE_DIR}/harness/native/joints.c ${library_sources})
set(live_options ${live_sources})
list(TRANSFORM live_options PREPEND "--sources;")
set(live_includes ${SIGMAHAT_NATIVE_INCLUDES})
list(TRANSFORM live_includes PREPEND "--includes;")
file(GLOB live_page CONFIGURE_DEPENDS docs/live/*)
file(GLOB live_python CONFIGURE_DEPENDS harness/sigmahat_build/web.py harness/sigmahat_build/system.py
     harness/sigmahat/paper/*.py harness/sigmahat/experiments/scenario.py)
add_custom_command(
  OUTPUT ${live}/compiled.js
  COMMAND ${SIGMAHAT_RUN} sigmahat_build live ${live} ${live_fmus}
          --page ${PROJECT_SOURCE_DIR}/docs/live --cache ${PROJECT_BINARY_DIR}/cross-compiler
          ${live_options} ${live_includes}
  DEPENDS ${live_fmus} ${live_page} ${live_sources} ${live_python}
          harness/native/joints.h ${packages_release} ${packages_docs}
  COMMENT "Page that runs plant and estimator in the browser" VERBATIM)
add_custom_target(live DEPENDS ${live}/compiled.js)
