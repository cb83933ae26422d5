# sigmahat_add_fmu(NAME STRUCT type STORAGE struct|sides|arrays SOURCES file...
#                  [LIBRARY target])
#
# Adds a target NAME that builds NAME.fmu from modelDescription/NAME.xml, the FMI shell, the
# given sources and those of the library. The FMU contains the binary of the host and the sources.
# STRUCT is the C type that contains the variables, STORAGE how they are stored in it: see
# harness/sigmahat/export/c_variables.py.
function(sigmahat_add_fmu name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "STRUCT;STORAGE;LIBRARY" "SOURCES")
  set(source_dir ${PROJECT_SOURCE_DIR})
  set(dir ${PROJECT_BINARY_DIR}/fmu/${name})
  set(template ${source_dir}/modelDescription/${name}.xml)
  file(GLOB shared CONFIGURE_DEPENDS ${source_dir}/modelDescription/*.xml
       ${source_dir}/harness/sigmahat/export/*.py ${source_dir}/harness/sigmahat/export/units.xml)

  get_target_property(sources sigmahat_shell SOURCES)
  list(APPEND sources ${arg_SOURCES})
  set(interface "")
  if(arg_LIBRARY)
    get_target_property(library_sources ${arg_LIBRARY} SOURCES)
    get_target_property(interface ${arg_LIBRARY} HEADER_SET)
    list(APPEND sources ${library_sources})
  endif()
  file(GLOB headers ${source_dir}/c/*.h ${source_dir}/c/*/*.h ${source_dir}/fmu_src/*.h)

  add_custom_command(
    OUTPUT ${dir}/modelDescription.xml ${dir}/variables.h
    COMMAND ${SIGMAHAT_RUN} sigmahat.export describe ${template} ${dir} ${sources}
            --version ${PROJECT_VERSION} --struct ${arg_STRUCT}
            --storage ${arg_STORAGE}
    DEPENDS ${shared}
    COMMENT "Model description of ${name}" VERBATIM)

  # The files for people: documentation and icons.
  file(GLOB pages ${source_dir}/modelDescription/documentation/*.html)
  set(shown ${dir}/shown)
  set(shown_files ${shown}/model.png ${shown}/documentation/index.html
                  ${shown}/documentation/icon.svg)
  add_custom_command(
    OUTPUT ${shown_files}
    COMMAND ${SIGMAHAT_RUN} sigmahat.export document ${template} ${shown}
            --version ${PROJECT_VERSION}
    DEPENDS ${shared} ${pages}
    COMMENT "Documentation of ${name}" VERBATIM)

  add_library(${name}_binary MODULE $<TARGET_OBJECTS:sigmahat_shell> ${arg_SOURCES}
              ${dir}/variables.h)
  target_include_directories(${name}_binary PRIVATE ${dir} ${source_dir}/fmu_src)
  target_include_directories(${name}_binary SYSTEM PRIVATE ${SIGMAHAT_FMI_HEADERS})
  set_target_properties(
    ${name}_binary PROPERTIES OUTPUT_NAME ${name} PREFIX "" C_VISIBILITY_PRESET hidden
                              LIBRARY_OUTPUT_DIRECTORY ${dir}/binary)
  if(APPLE)
    set_target_properties(${name}_binary PROPERTIES SUFFIX ".dylib")
  endif()
  target_link_libraries(${name}_binary PRIVATE ${arg_LIBRARY} ${SIGMAHAT_MATH})

  set(fmu ${SIGMAHAT_FMU_FOLDER}/${name}.fmu)
  add_custom_command(
    OUTPUT ${fmu}
    COMMAND ${SIGMAHAT_RUN} sigmahat.export pack ${fmu} ${sources} ${interface} ${dir}/variables.h
            --description ${dir}/modelDescription.xml --binary $<TARGET_FILE:${name}_binary>
            --licence ${source_dir}/LICENSE --shown ${shown}
    DEPENDS ${name}_binary ${dir}/modelDescription.xml ${source_dir}/LICENSE ${shown_files}
            ${shared} ${headers}
    WORKING_DIRECTORY ${source_dir}
    COMMENT "Packing ${name}.fmu" VERBATIM)
  add_custom_target(${name} ALL DEPENDS ${fmu})
  set_property(GLOBAL APPEND PROPERTY SIGMAHAT_FMUS ${fmu})
endfunction()

# sigmahat_add_estimator(NAME STRUCT type STORAGE struct|sides): an FMU of the C library.
function(sigmahat_add_estimator name)
  sigmahat_add_fmu(${name} ${ARGN} SOURCES fmu_src/${name}.c fmu_src/estimator_fmu.c
                   fmu_src/sample_clock.c LIBRARY sigmahat_c)
endfunction()

# sigmahat_add_plant(NAME): the FMU of a plant whose equations are in harness/sigmahat/plants.
function(sigmahat_add_plant name)
  set(dir ${PROJECT_BINARY_DIR}/fmu/${name})
  file(GLOB equations CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/harness/sigmahat/plants/*.py
       ${PROJECT_SOURCE_DIR}/harness/sigmahat/export/*.py)
  add_custom_command(
    OUTPUT ${dir}/plant_functions.c ${dir}/plant_functions.h
    COMMAND ${SIGMAHAT_RUN} sigmahat.export.plant_codegen ${name} ${dir}
    DEPENDS ${equations} ${PROJECT_SOURCE_DIR}/modelDescription/${name}.xml
            ${PROJECT_SOURCE_DIR}/modelDescription/plant_macros.xml
    COMMENT "Equations of ${name}" VERBATIM)
  sigmahat_add_fmu(${name} STRUCT sh_plant STORAGE arrays SOURCES
                   fmu_src/plant.c fmu_src/radau.c fmu_src/noise.c
                   ${dir}/plant_functions.c)
endfunction()
