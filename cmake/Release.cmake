# The target release writes all FMUs and the system to release/, with binaries for all platforms, and
# copies of the estimators without enumerations. It also writes a wheel for each platform and the source distribution to release/python/.
#
# The cross compiler is a large download, so only the targets release and web install it.
sigmahat_add_packages(release)

set(without_enumerations "")
foreach(fmi 2 3)
  get_property(fmus GLOBAL PROPERTY SIGMAHAT_FMUS_${fmi})
  set(released_${fmi} "")
  foreach(fmu IN LISTS fmus)
    cmake_path(GET fmu FILENAME file)
    set(release ${PROJECT_BINARY_DIR}/release/${file})
    add_custom_command(
      OUTPUT ${release}
      COMMAND ${SIGMAHAT_RUN} sigmahat_build release ${fmu} ${release}
              --cache ${PROJECT_BINARY_DIR}/cross-compiler
      DEPENDS ${fmu} ${packages_release}
      COMMENT "Compiling ${file} for every platform" VERBATIM)
    list(APPEND released_${fmi} ${release})
    # For importers that cannot set enumerations. No plant has any.
    if(file MATCHES "Estimator")
      cmake_path(GET file STEM name)
      set(integers ${PROJECT_BINARY_DIR}/release/${name}_Integers.fmu)
      add_custom_command(
        OUTPUT ${integers}
        COMMAND ${SIGMAHAT_RUN} sigmahat_build integers ${release} ${integers}
        DEPENDS ${release} harness/sigmahat_build/integers.py
        COMMENT "Copy of ${file} without enumerations" VERBATIM)
      list(APPEND without_enumerations ${integers})
    endif()
  endforeach()
endforeach()
set(release ${PROJECT_BINARY_DIR}/release)
sigmahat_add_system(${release}/sigmahat-awas.ssp ${release}/AwasPlant.fmu
                    ${release}/StiffnessEstimator.fmu)

get_target_property(native_sources sigmahat_native SOURCES)
get_target_property(library_sources sigmahat_c SOURCES)
list(FILTER native_sources INCLUDE REGEX "[.]c$")
list(TRANSFORM native_sources PREPEND ${PROJECT_SOURCE_DIR}/)
set(compiled ${native_sources} ${library_sources})
list(TRANSFORM compiled PREPEND "--sources;")
set(included ${SIGMAHAT_NATIVE_INCLUDES})
list(TRANSFORM included PREPEND "--includes;")
file(GLOB_RECURSE package CONFIGURE_DEPENDS harness/*)
list(FILTER package EXCLUDE REGEX "__pycache__")
add_custom_command(
  OUTPUT ${release}/python.stamp
  COMMAND ${SIGMAHAT_RUN} sigmahat_build distribute ${release}/python
          ${released_2} ${release}/sigmahat-awas.ssp --project ${PROJECT_SOURCE_DIR}
          ${compiled} ${included} --cache ${PROJECT_BINARY_DIR}/cross-compiler
  COMMAND ${CMAKE_COMMAND} -E touch ${release}/python.stamp
  DEPENDS ${released_2} ${release}/sigmahat-awas.ssp ${package} ${library_sources}
          pyproject.toml ${packages_release} StiffnessEstimator
  COMMENT "Wheels and source distribution" VERBATIM)

# The bill of materials lists the components of all released files, and the tools that built them.
set(bill ${release}/sigmahat.cdx.json)
add_custom_command(
  OUTPUT ${bill}
  COMMAND ${SIGMAHAT_RUN} sigmahat_build bill ${bill} ${release} --version ${PROJECT_VERSION}
  DEPENDS ${released_2} ${released_3} ${without_enumerations} ${release}/sigmahat-awas.ssp
          ${release}/python.stamp
          ${release}/sigmahat-modelica.zip ${packages_release}
          harness/sigmahat_build/bill.py
  COMMENT "Bill of materials" VERBATIM)
add_custom_target(
  release DEPENDS ${released_2} ${released_3} ${without_enumerations} ${release}/sigmahat-awas.ssp
                  ${release}/python.stamp ${bill})
