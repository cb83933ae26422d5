# Sets up a Python environment in the build tree, with the versions pinned in requirements/. A build
# of the Python package (SKBUILD) uses the environment of that build instead, which has the
# requirements of pyproject.toml.
#
# The environment begins with requirements/reproduce.txt, which the FMUs and Table I need. Targets
# that need more packages install them when they are built: see sigmahat_add_packages. With
# SIGMAHAT_LOWEST the environment has the packages of all purposes from requirements/lowest.txt, in the
# lowest versions that pyproject.toml allows.
#
# Sets SIGMAHAT_PYTHON (interpreter), SIGMAHAT_RUN (command that runs one of our modules) and
# SIGMAHAT_FMU_FOLDER (folder for the FMUs). For an environment in the build tree it also sets
# SIGMAHAT_VENV (its folder), SIGMAHAT_PIP (command that installs packages) and SIGMAHAT_NINJA.

# Commands import the modules of this source tree, even if another version of them is installed.
set(SIGMAHAT_RUN ${CMAKE_COMMAND} -E env --modify
    PYTHONPATH=path_list_prepend:${CMAKE_CURRENT_SOURCE_DIR}/harness)
if(SKBUILD)
  set(SIGMAHAT_PYTHON ${Python_EXECUTABLE})
  list(APPEND SIGMAHAT_RUN ${SIGMAHAT_PYTHON} -m)
  set(SIGMAHAT_FMU_FOLDER ${CMAKE_CURRENT_BINARY_DIR}/fmus)
  return()
endif()

option(SIGMAHAT_LOWEST "Install the lowest versions of packages that pyproject.toml allows" OFF)
find_program(SIGMAHAT_HOST_PYTHON NAMES python3 python REQUIRED)
execute_process(
  COMMAND ${SIGMAHAT_HOST_PYTHON} -c "import sys; sys.exit(sys.version_info < (3, 10))"
  RESULT_VARIABLE too_old)
if(too_old EQUAL 1)
  message(FATAL_ERROR "${SIGMAHAT_HOST_PYTHON} is older than Python 3.10. Install a newer one, "
                      "or name it: -D SIGMAHAT_HOST_PYTHON=/path/to/python3.")
elseif(too_old)
  message(FATAL_ERROR "${SIGMAHAT_HOST_PYTHON} cannot be run (${too_old}). Install Python 3.10 or "
                      "newer, or name one: -D SIGMAHAT_HOST_PYTHON=/path/to/python3.")
endif()

set(SIGMAHAT_VENV ${CMAKE_CURRENT_BINARY_DIR}/venv)
if(CMAKE_HOST_WIN32)
  set(SIGMAHAT_PYTHON ${SIGMAHAT_VENV}/Scripts/python.exe)
  set(SIGMAHAT_NINJA ${SIGMAHAT_VENV}/Scripts/ninja.exe)
else()
  set(SIGMAHAT_PYTHON ${SIGMAHAT_VENV}/bin/python)
  set(SIGMAHAT_NINJA ${SIGMAHAT_VENV}/bin/ninja)
endif()
list(APPEND SIGMAHAT_RUN ${SIGMAHAT_PYTHON} -m)
set(SIGMAHAT_FMU_FOLDER ${SIGMAHAT_VENV}/share/sigmahat)

# pip installs no dependencies, because a file in requirements/ lists every package. pip compiles no
# modules either, because Python compiles a module at its first import and most are never imported.
set(SIGMAHAT_PIP ${SIGMAHAT_PYTHON} -m pip install --disable-pip-version-check --no-deps
                 --no-compile)

# sigmahat_requirements(PURPOSE FILE) sets the variable FILE to the path of the file with the packages of PURPOSE.
function(sigmahat_requirements purpose file)
  if(SIGMAHAT_LOWEST)
    set(purpose lowest)
  endif()
  set(${file} ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../requirements/${purpose}.txt PARENT_SCOPE)
endfunction()

# sigmahat_add_packages(PURPOSE) adds the target packages_PURPOSE, which installs the packages of
# requirements/PURPOSE.txt. The variable packages_PURPOSE then contains the path of a stamp file.
function(sigmahat_add_packages purpose)
  sigmahat_requirements(${purpose} requirements)
  set(installed ${SIGMAHAT_VENV}/packages-${purpose})
  add_custom_command(
    OUTPUT ${installed}
    COMMAND ${SIGMAHAT_PIP} -r ${requirements}
    COMMAND ${CMAKE_COMMAND} -E touch ${installed}
    DEPENDS ${requirements}
    COMMENT "Installing the packages for ${purpose}"
    USES_TERMINAL # shows progress, and lets one pip run at a time
    VERBATIM)
  add_custom_target(packages_${purpose} DEPENDS ${installed})
  set(packages_${purpose} ${installed} PARENT_SCOPE)
endfunction()

sigmahat_requirements(reproduce requirements)
set(pyproject ${CMAKE_CURRENT_SOURCE_DIR}/pyproject.toml)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${requirements} ${pyproject})
file(SHA256 ${requirements} wanted)
file(SHA256 ${pyproject} pyproject_hash)
string(APPEND wanted ${pyproject_hash})
set(stamp ${SIGMAHAT_VENV}/packages-reproduce)
set(installed "")
if(EXISTS ${stamp})
  file(READ ${stamp} installed)
endif()
if(NOT installed STREQUAL wanted)
  message(STATUS "Setting up Python in ${SIGMAHAT_VENV}, once; then pip installs what the FMUs and "
                 "Table I need")
  execute_process(COMMAND ${SIGMAHAT_HOST_PYTHON} -m venv ${SIGMAHAT_VENV} RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "${SIGMAHAT_HOST_PYTHON} cannot make a virtual environment. "
                        "On Debian and Ubuntu: apt-get install python3-venv.")
  endif()
  foreach(arguments "-r;${requirements}" "--quiet;--no-build-isolation;-e;.")
    execute_process(
      COMMAND ${SIGMAHAT_PIP} ${arguments}
      WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}
      RESULT_VARIABLE failed)
    if(failed)
      message(FATAL_ERROR "pip could not install ${arguments}; see its message above.")
    endif()
  endforeach()
  file(WRITE ${stamp} ${wanted})
endif()
