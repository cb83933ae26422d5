# sigmahat_add_system(SSP PLANT ESTIMATOR)
#
# Writes the file SSP, which contains the connected FMUs PLANT and ESTIMATOR with the parameters of
# Table I. All three arguments are full paths.
function(sigmahat_add_system ssp plant estimator)
  set(templates ${PROJECT_SOURCE_DIR}/modelDescription/system)
  file(GLOB sources CONFIGURE_DEPENDS ${templates}/* ${PROJECT_SOURCE_DIR}/harness/sigmahat/result/templates/*.ssv ${PROJECT_SOURCE_DIR}/harness/sigmahat/fmi/*.py ${PROJECT_SOURCE_DIR}/harness/sigmahat/paper/*.py
       ${PROJECT_SOURCE_DIR}/harness/sigmahat/experiments/*.py
       ${PROJECT_SOURCE_DIR}/harness/sigmahat/plant_fmu/archive.py
       ${PROJECT_SOURCE_DIR}/harness/sigmahat_build/*.py)
  cmake_path(GET ssp FILENAME name)
  add_custom_command(
    OUTPUT ${ssp}
    COMMAND ${SIGMAHAT_RUN} sigmahat_build system ${ssp} ${plant} ${estimator}
            --templates ${templates} --version ${PROJECT_VERSION}
    DEPENDS ${plant} ${estimator} ${sources}
    COMMENT "Packing ${name}" VERBATIM)
endfunction()

set(fmus ${SIGMAHAT_FMU_FOLDER})
sigmahat_add_system(${fmus}/sigmahat-awas.ssp ${fmus}/AwasPlant.fmu
                    ${fmus}/StiffnessEstimator.fmu)
add_custom_target(awas_system ALL DEPENDS ${fmus}/sigmahat-awas.ssp)
