# Installs the locked packages into WORK and bundles map_view.js into BUNDLE. A failure (no network)
# is no reason for the build to fail: the bundle is left out, and tried again when its sources
# change or STAMP is removed.
file(MAKE_DIRECTORY ${WORK})
file(COPY ${SOURCE}/package.json ${SOURCE}/package-lock.json ${SOURCE}/map_view.js
     DESTINATION ${WORK})
file(REMOVE ${BUNDLE})
execute_process(
  COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --fetch-retries=1 --fetch-timeout=20000
  WORKING_DIRECTORY ${WORK} RESULT_VARIABLE failed OUTPUT_QUIET ERROR_VARIABLE reason)
if(NOT failed)
  execute_process(
    COMMAND ${NPM} run --silent bundle -- --outfile=${BUNDLE}
    WORKING_DIRECTORY ${WORK} RESULT_VARIABLE failed OUTPUT_QUIET ERROR_VARIABLE reason)
endif()
if(failed)
  file(REMOVE ${BUNDLE})
  message("The report's 3D view could not be bundled; reports show a drawing instead.\n${reason}")
endif()
file(TOUCH ${STAMP})
