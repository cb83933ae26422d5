# The target web writes the page of docs/web to web/, with plant and estimator as WebAssembly. The
# target docs copies this page to the site. The plant is an FMU. The estimator is the library with the
# functions that the Python package calls.
set(web ${PROJECT_BINARY_DIR}/web)
set(web_fmus ${SIGMAHAT_FMU_FOLDER}/AwasPlant.fmu ${SIGMAHAT_FMU_FOLDER}/StiffnessEstimator.fmu)
get_target_property(library_sources sigmahat_c SOURCES)
set(web_sources ${PROJECT_SOURCE_DIR}/harness/native/joints.c ${library_sources})
set(web_options ${web_sources})
list(TRANSFORM web_options PREPEND "--sources;")
set(web_includes ${SIGMAHAT_NATIVE_INCLUDES})
list(TRANSFORM web_includes PREPEND "--includes;")
file(GLOB web_page CONFIGURE_DEPENDS docs/web/*)
file(GLOB web_python CONFIGURE_DEPENDS harness/sigmahat_build/web.py harness/sigmahat_build/system.py
     harness/sigmahat/estimator/*.py harness/sigmahat/paper/*.py
     harness/sigmahat/experiments/scenario.py)
add_custom_command(
  OUTPUT ${web}/compiled.js
  COMMAND ${SIGMAHAT_RUN} sigmahat_build web ${web} ${web_fmus}
          --page ${PROJECT_SOURCE_DIR}/docs/web --cache ${PROJECT_BINARY_DIR}/cross-compiler
          ${web_options} ${web_includes}
  DEPENDS ${web_fmus} ${web_page} ${web_sources} ${web_python}
          harness/native/joints.h ${packages_release} ${packages_docs}
  COMMENT "Page that runs plant and estimator in the browser" VERBATIM)
add_custom_target(web DEPENDS ${web}/compiled.js)
