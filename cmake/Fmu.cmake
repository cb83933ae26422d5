# sigmahat_add_fmu(NAME STRUCT type STORAGE struct|sides|arrays SOURCES file...
#                  [LIBRARY target])
#
# Adds the target NAME, which builds NAME.fmu, and the target NAME_FMI3, which builds the FMU
# fmi3/NAME_FMI3.fmu for FMI 3.0. Both are built from modelDescription/NAME.xml, the FMI shell, the
# given sources and the sources of the library. An FMU contains all sources and a binary for the host.
# STRUCT is the C type that contains the variables. STORAGE tells how this type stores them, see
# harness/sigmahat_build/storage.py.
function(sigmahat_add_fmu name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "STRUCT;STORAGE;LIBRARY" "SOURCES")
  set(source_dir ${PROJECT_SOURCE_DIR})
  set(dir ${PROJECT_BINARY_DIR}/fmu/${name})
  set(template ${source_dir}/modelDescription/${name}.xml)
  file(GLOB shared CONFIGURE_DEPENDS ${source_dir}/modelDescription/*.xml ${source_dir}/harness/sigmahat_build/*.py
       ${source_dir}/harness/sigmahat/plant_fmu/*.py ${source_dir}/harness/sigmahat/plant_fmu/*.xml)

  set(sources "")
  foreach(part shell fmi2 fmi3)
    get_target_property(part_sources sigmahat_${part} SOURCES)
    list(APPEND sources ${part_sources})
  endforeach()
  list(APPEND sources ${arg_SOURCES})
  set(interface "")
  if(arg_LIBRARY)
    get_target_property(library_sources ${arg_LIBRARY} SOURCES)
    get_target_property(interface ${arg_LIBRARY} HEADER_SET)
    list(APPEND sources ${library_sources})
  endif()
  file(GLOB headers ${source_dir}/c/*.inc ${source_dir}/c/*.h ${source_dir}/c/*/*.h ${source_dir}/fmu_src/*.h ${source_dir}/fmu_src/*/*.h)

  set(described ${dir}/modelDescription.xml ${dir}/fmi3/modelDescription.xml
                ${dir}/fmi3/buildDescription.xml ${dir}/fmi3/terminalsAndIcons.xml)
  add_custom_command(
    OUTPUT ${described} ${dir}/variables.h
    COMMAND ${SIGMAHAT_RUN} sigmahat_build describe ${template} ${dir} ${sources}
            --version ${PROJECT_VERSION} --struct ${arg_STRUCT}
            --storage ${arg_STORAGE}
    DEPENDS ${shared}
    COMMENT "Model descriptions of ${name}" VERBATIM)

  # The object files of the model do not depend on the version of FMI.
  add_library(${name}_model OBJECT ${arg_SOURCES} ${dir}/variables.h)
  target_include_directories(${name}_model PRIVATE ${dir} ${source_dir}/fmu_src
                             $<$<BOOL:${arg_LIBRARY}>:$<TARGET_PROPERTY:${arg_LIBRARY},INTERFACE_INCLUDE_DIRECTORIES>>)
  set_target_properties(${name}_model PROPERTIES C_VISIBILITY_PRESET hidden)

  # Documentation and icons of the FMU.
  file(GLOB pages ${source_dir}/modelDescription/documentation/*.html ${source_dir}/modelDescription/icons/${name}.*)
  set(shown ${dir}/shown)
  set(shown_files
      ${shown}/fmi2/model.png ${shown}/fmi2/documentation/icon.svg
      ${shown}/fmi2/documentation/index.html ${shown}/fmi3/terminalsAndIcons/icon.png
      ${shown}/fmi3/terminalsAndIcons/icon.svg ${shown}/fmi3/documentation/index.html)
  add_custom_command(
    OUTPUT ${shown_files}
    COMMAND ${SIGMAHAT_RUN} sigmahat_build document ${template} ${shown}
            --version ${PROJECT_VERSION}
    DEPENDS ${shared} ${pages}
    COMMENT "Documentation of ${name}" VERBATIM)

  foreach(fmi 2 3)
    set(target ${name})
    set(fmu ${SIGMAHAT_FMU_FOLDER}/${name}.fmu)
    if(fmi EQUAL 3)
      set(target ${name}_FMI3)
      set(fmu ${PROJECT_BINARY_DIR}/fmi3/${name}_FMI3.fmu)
    endif()

    add_library(${target}_binary MODULE $<TARGET_OBJECTS:sigmahat_shell>
                $<TARGET_OBJECTS:sigmahat_fmi${fmi}> $<TARGET_OBJECTS:${name}_model>)
    set_target_properties(
      ${target}_binary PROPERTIES OUTPUT_NAME ${name} PREFIX "" LINKER_LANGUAGE C
                                  LIBRARY_OUTPUT_DIRECTORY ${dir}/binary${fmi})
    if(APPLE)
      set_target_properties(${target}_binary PROPERTIES SUFFIX ".dylib")
    endif()
    target_link_libraries(${target}_binary PRIVATE ${arg_LIBRARY} ${SIGMAHAT_MATH})

    add_custom_command(
      OUTPUT ${fmu}
      COMMAND ${SIGMAHAT_RUN} sigmahat_build pack ${fmu} ${sources} ${interface} ${dir}/variables.h
              --fmi ${fmi} --described ${dir} --binary $<TARGET_FILE:${target}_binary>
              --licence ${source_dir}/LICENSE --shown ${shown}/fmi${fmi}
      DEPENDS ${target}_binary ${described} ${source_dir}/LICENSE ${shown_files} ${shared} ${headers}
      WORKING_DIRECTORY ${source_dir}
      COMMENT "Packing ${target}.fmu" VERBATIM)
    set(all ALL)
    if(SKBUILD AND fmi EQUAL 3) # a wheel contains no FMUs for FMI 3.0
      set(all "")
      set_target_properties(${target}_binary PROPERTIES EXCLUDE_FROM_ALL TRUE)
    endif()
    add_custom_target(${target} ${all} DEPENDS ${fmu})
    set_property(GLOBAL APPEND PROPERTY SIGMAHAT_FMUS_${fmi} ${fmu})
  endforeach()
endfunction()

# sigmahat_add_estimator(NAME STRUCT type STORAGE struct|sides) adds the FMU of an estimator of the C library.
function(sigmahat_add_estimator name)
  sigmahat_add_fmu(${name} ${ARGN} SOURCES fmu_src/${name}.c fmu_src/estimator_fmu.c
                   LIBRARY sigmahat_c)
endfunction()

# sigmahat_add_plant(NAME) adds the FMU of a plant whose equations are in harness/sigmahat/plants.
function(sigmahat_add_plant name)
  set(dir ${PROJECT_BINARY_DIR}/fmu/${name})
  set(template ${PROJECT_SOURCE_DIR}/modelDescription/${name}.xml)
  file(GLOB equations CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/harness/sigmahat/plants/*.py
       ${PROJECT_SOURCE_DIR}/harness/sigmahat/plant_fmu/*.py
       ${PROJECT_SOURCE_DIR}/harness/sigmahat_build/*.py)
  add_custom_command(
    OUTPUT ${dir}/plant_functions.c ${dir}/plant_functions.h
    COMMAND ${SIGMAHAT_RUN} sigmahat_build equations ${template} ${dir}
    DEPENDS ${equations} ${template}
            ${PROJECT_SOURCE_DIR}/modelDescription/plant_macros.xml
    COMMENT "Equations of ${name}" VERBATIM)
  sigmahat_add_fmu(${name} STRUCT sh_plant STORAGE arrays SOURCES
                   fmu_src/plant.c fmu_src/radau.c fmu_src/noise.c
                   ${dir}/plant_functions.c)
endfunction()
