# The target pins writes requirements/*.txt from pyproject.toml. These files pin the versions and hashes of all
# packages for the build tree. A pinned version does not change as long as pyproject.toml allows it. To get newer
# versions, remove requirements/test.txt first. requirements/lowest.txt has the lowest versions that pyproject.toml
# allows, and for what the packages need themselves, the newest.
set(compile
    ${CMAKE_COMMAND} -E env "UV_CUSTOM_COMPILE_COMMAND=cmake --build build --target pins"
    ${SIGMAHAT_PYTHON} -m uv pip compile --quiet --universal --python-version 3.10
    --generate-hashes --no-annotate)
set(consistent ${compile} --constraints requirements/test.txt)
add_custom_target(
  pins
  COMMAND ${SIGMAHAT_PYTHON} -m pip install --quiet --disable-pip-version-check uv
  COMMAND ${compile} pyproject.toml --all-extras --group test -o requirements/test.txt
  COMMAND ${consistent} --group reproduce --excludes requirements/not-for-reproduce.txt
          -o requirements/reproduce.txt
  COMMAND ${consistent} --group release -o requirements/release.txt
  COMMAND ${consistent} --group coverage -o requirements/coverage.txt
  COMMAND ${consistent} pyproject.toml --group docs -o requirements/docs.txt
  COMMAND ${consistent} --group rivals -o requirements/rivals.txt
  COMMAND ${compile} --resolution lowest-direct pyproject.toml --all-extras --group test
          -o requirements/lowest.txt
  WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
  COMMENT "Writing requirements/*.txt" VERBATIM)
