# sigmahat-awas.ssp: AwasPlant and StiffnessEstimator, connected, with the parameters of Table I.
set(fmus ${SIGMAHAT_VENV}/share/sigmahat)
set(templates ${PROJECT_SOURCE_DIR}/modelDescription/system)
file(GLOB sources ${templates}/* ${PROJECT_SOURCE_DIR}/harness/sigmahat/*.py
     ${PROJECT_SOURCE_DIR}/harness/sigmahat/export/*.py)
add_custom_command(
  OUTPUT ${fmus}/sigmahat-awas.ssp
  COMMAND ${SIGMAHAT_PYTHON} -m sigmahat.export system ${fmus}/sigmahat-awas.ssp
          ${fmus}/AwasPlant.fmu ${fmus}/StiffnessEstimator.fmu --templates ${templates}
  DEPENDS ${fmus}/AwasPlant.fmu ${fmus}/StiffnessEstimator.fmu ${sources}
  COMMENT "Packing sigmahat-awas.ssp" VERBATIM)
add_custom_target(awas_system ALL DEPENDS ${fmus}/sigmahat-awas.ssp)
