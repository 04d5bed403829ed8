# Installs this build into a fresh prefix, builds the project in consumer/ against it and runs that on an
# asset cooked here. cmake -DBUILD=<build folder> -DCONSUMER=<source folder> -DWORK=<scratch folder> -P this
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})

function(run)
  execute_process(COMMAND ${ARGV} WORKING_DIRECTORY ${WORK} RESULT_VARIABLE status OUTPUT_VARIABLE output
                  ERROR_VARIABLE errors)
  if(NOT status EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "exit status ${status} from: ${command}\n${output}\n${errors}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
foreach(file bin/loden include/loden/material/eval/evaluate.h share/loden/shaders/loden_material.glsl)
  if(NOT EXISTS ${WORK}/prefix/${file})
    message(FATAL_ERROR "not installed: ${file}")
  endif()
endforeach()

# No installed header includes one that stays behind.
file(GLOB_RECURSE headers RELATIVE ${WORK}/prefix/include/loden ${WORK}/prefix/include/loden/*.h)
foreach(header IN LISTS headers)
  file(STRINGS ${WORK}/prefix/include/loden/${header} includes REGEX "^#include \"")
  foreach(line IN LISTS includes)
    string(REGEX REPLACE "^#include \"([^\"]+)\".*" "\\1" included "${line}")
    if(NOT included IN_LIST headers)
      message(FATAL_ERROR "${header} includes ${included}, which is not installed")
    endif()
  endforeach()
endforeach()

run(${WORK}/prefix/bin/loden bake builtin:sponge -o ${WORK}/sponge --size 8 --directions bonn81)
run(${WORK}/prefix/bin/loden cook ${WORK}/sponge -o ${WORK}/sponge.loden --mode surface)

# Embree and Ceres hidden: a consumer of Loden::material must not need them.
run(${CMAKE_COMMAND} -S ${CONSUMER} -B ${WORK}/build -G Ninja -DCMAKE_PREFIX_PATH=${WORK}/prefix
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_DISABLE_FIND_PACKAGE_embree=ON -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON)
run(${CMAKE_COMMAND} --build ${WORK}/build)
foreach(program consumer engine)
  run(${WORK}/build/${program} ${WORK}/sponge.loden)
  if(NOT output MATCHES "^-?[0-9.e-]+ -?[0-9.e-]+ -?[0-9.e-]+\n$")
    message(FATAL_ERROR "${program}: expected one linear RGB value, got: ${output}")
  endif()
  message(STATUS "${program} says ${output}")
endforeach()

# EMBEDDING.md shows this very program.
file(READ ${CONSUMER}/main.cpp program)
file(READ ${WORK}/prefix/share/doc/Loden/runtime/EMBEDDING.md page)
string(FIND "${page}" "${program}" place)
if(place EQUAL -1)
  message(FATAL_ERROR "runtime/EMBEDDING.md does not show ${CONSUMER}/main.cpp as it is")
endif()
