# The target live writes the page of docs/live to live/, with plant and estimator as WebAssembly. The
# target docs copies this page to the site.
set(live ${PROJECT_BINARY_DIR}/live)
set(live_fmus ${SIGMAHAT_FMU_FOLDER}/AwasPlant.fmu ${SIGMAHAT_FMU_FOLDER}/StiffnessEstimator.fmu)
file(GLOB live_page CONFIGURE_DEPENDS docs/live/*)
file(GLOB live_sources CONFIGURE_DEPENDS harness/sigmahat_build/web.py harness/sigmahat_build/system.py
     harness/sigmahat/paper/*.py harness/sigmahat/experiments/scenario.py
     harness/sigmahat/guess/vocabulary.toml)
add_custom_command(
  OUTPUT ${live}/fmus.js
  COMMAND ${SIGMAHAT_RUN} sigmahat_build live ${live} ${live_fmus}
          --page ${PROJECT_SOURCE_DIR}/docs/live --cache ${PROJECT_BINARY_DIR}/cross-compiler
  DEPENDS ${live_fmus} ${live_page} ${live_sources}
          ${packages_release} ${packages_docs}
  COMMENT "Page that runs the FMUs in the browser" VERBATIM)
add_custom_target(live DEPENDS ${live}/fmus.js)
