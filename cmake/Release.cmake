# Target release: writes every FMU and the system to release/, with the binaries of all platforms.
#
# The cross compiler is a large download, so it is installed only for this target.
sigmahat_add_packages(release)

get_property(fmus GLOBAL PROPERTY SIGMAHAT_FMUS)
set(released "")
foreach(fmu IN LISTS fmus)
  cmake_path(GET fmu FILENAME file)
  set(release ${PROJECT_BINARY_DIR}/release/${file})
  add_custom_command(
    OUTPUT ${release}
    COMMAND ${SIGMAHAT_RUN} sigmahat.export release ${fmu} ${release}
            --cache ${PROJECT_BINARY_DIR}/cross-compiler
    DEPENDS ${fmu} ${packages_release}
    COMMENT "Compiling ${file} for every platform" VERBATIM)
  list(APPEND released ${release})
endforeach()
set(release ${PROJECT_BINARY_DIR}/release)
sigmahat_add_system(${release}/sigmahat-awas.ssp ${release}/AwasPlant.fmu
                    ${release}/StiffnessEstimator.fmu)
add_custom_target(release DEPENDS ${released} ${release}/sigmahat-awas.ssp)
