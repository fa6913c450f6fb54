# Runs `program` with every set-up of the worker, half a second each, on small images that it writes into `work`.
file(REMOVE_RECURSE ${work})
execute_process(
  COMMAND ${program} --seconds 0.5 --work 1 --sky-size 32 --level-size 64 --no-plot -o ${work}
          --setup own-idle,own-below,own-normal,lent,lent-engine
  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE errors)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "engine_loop ended with ${result}\n${output}${errors}")
endif()
if(NOT output MATCHES "bit by bit")
  message(FATAL_ERROR "engine_loop did not say that the light is the same:\n${output}")
endif()

# Thirty frames of each of the seven runs, after a line that names the columns.
file(STRINGS ${work}/frames.csv lines)
list(LENGTH lines count)
if(NOT count EQUAL 211)
  message(FATAL_ERROR "${work}/frames.csv has ${count} lines instead of 211")
endif()
foreach(run IN ITEMS "no baking" synchronous own-idle own-below own-normal lent lent-engine)
  set(of_run ${lines})
  list(FILTER of_run INCLUDE REGEX "^${run},")
  list(LENGTH of_run count)
  if(NOT count EQUAL 30)
    message(FATAL_ERROR "${work}/frames.csv has ${count} frames of '${run}' instead of 30")
  endif()
endforeach()
