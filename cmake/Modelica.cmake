# The target modelica, a part of the target release, writes the Modelica package with its C sources
# to release/sigmahat-modelica.zip.
set(modelica ${PROJECT_BINARY_DIR}/release/sigmahat-modelica.zip)
set(modelica_sources ${amalgamation}/sigmahat.c ${amalgamation}/sigmahat.h
                     ${PROJECT_SOURCE_DIR}/fmu_src/noise.c ${PROJECT_SOURCE_DIR}/fmu_src/noise.h)
file(GLOB_RECURSE modelica_package CONFIGURE_DEPENDS modelica/Sigmahat/*)
file(GLOB modelica_variables CONFIGURE_DEPENDS modelDescription/*.xml)
add_custom_command(
  OUTPUT ${modelica}
  COMMAND ${SIGMAHAT_RUN} sigmahat_build modelica ${modelica} ${PROJECT_SOURCE_DIR}/modelica/Sigmahat
          ${modelica_sources} --descriptions ${PROJECT_SOURCE_DIR}/modelDescription
          --licence ${PROJECT_SOURCE_DIR}/LICENSE --version ${PROJECT_VERSION}
  DEPENDS ${modelica_package} ${modelica_variables} ${modelica_sources} LICENSE
          harness/sigmahat_build/modelica.py harness/sigmahat_build/description_template.py
          harness/sigmahat/plant_fmu/model_description.py harness/sigmahat/plant_fmu/archive.py
  COMMENT "Modelica package" VERBATIM)
add_custom_target(modelica DEPENDS ${modelica})
add_dependencies(release modelica)
