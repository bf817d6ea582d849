# Strategy: install into an empty prefix, build a small program that knows that prefix only, run it; then ask the installed
# program for a robot that exists nowhere but in the prefix.
function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${what} failed (${status}):\n${output}")
  endif()
endfunction()

set(prefix "${WORK_DIR}/prefix")
file(REMOVE_RECURSE "${WORK_DIR}")
run("installing" ${CMAKE_COMMAND} --install "${BUILD_DIR}" --prefix "${prefix}")

set(flags "")
if(SANITIZE)
  set(flags "-fsanitize=${SANITIZE}")
endif()
run("configuring the consumer" ${CMAKE_COMMAND} -S "${SOURCE_DIR}/consumer" -B "${WORK_DIR}/consumer" -G Ninja
    "-DCMAKE_BUILD_TYPE=${CONFIG}" "-DCMAKE_PREFIX_PATH=${prefix}" "-DCMAKE_CXX_COMPILER=${COMPILER}"
    "-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}" "-DCMAKE_CXX_FLAGS=${flags}")
file(GLOB leaks "${prefix}/lib*/cmake/ajar/ajarTargets*.cmake")
foreach(file IN LISTS leaks)
  file(STRINGS "${file}" lines REGEX "ajar_warnings|-Wall|${BUILD_DIR}")
  if(lines)
    message(FATAL_ERROR "${file} carries what belongs to the build: ${lines}")
  endif()
endforeach()
run("building the consumer" ${CMAKE_COMMAND} --build "${WORK_DIR}/consumer")
run("running the consumer" "${WORK_DIR}/consumer/consumer" "${prefix}/share/ajar/robots/heron/heron.urdf")

set(robots "${prefix}/share/ajar/robots")
file(MAKE_DIRECTORY "${robots}/stranger")
file(COPY_FILE "${robots}/heron/heron.urdf" "${robots}/stranger/stranger.urdf")
file(COPY_FILE "${robots}/heron/heron.toml" "${robots}/stranger/stranger.toml")
file(WRITE "${WORK_DIR}/scenario.toml" "robot = \"stranger\"\n[mechanism]\ntype = \"hinge\"\n[plant]\nkind = \"kinematic\"\n")
run("asking the installed program for an installed robot" ${CMAKE_COMMAND} -E env --unset=AJAR_ROBOTS
    "${prefix}/bin/ajar" validate "${WORK_DIR}/scenario.toml")
run("building an installed scenario in physics" ${CMAKE_COMMAND} -E env --unset=AJAR_ROBOTS
    "${prefix}/bin/ajar" validate "${prefix}/share/ajar/scenarios/demo.toml")
