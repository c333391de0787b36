# Compiles one shader to a C header.
# cmake -DCOMPILER= -DSOURCE= -DOUTPUT= -DDEPFILE= -DNAME= -DDEFINES="A=1 B=0" -P compile_shader.cmake
# glslangValidator has no option that turns warnings into errors, so anything it says that is not the file's name fails here.
separate_arguments(define_list UNIX_COMMAND "${DEFINES}")
list(TRANSFORM define_list PREPEND "-D")
execute_process(
  COMMAND ${COMPILER} --quiet --target-env vulkan1.1 ${define_list} --depfile ${DEPFILE} --vn ${NAME} -o ${OUTPUT} ${SOURCE}
  OUTPUT_VARIABLE text
  ERROR_VARIABLE text
  RESULT_VARIABLE status)
if(NOT status EQUAL 0 OR text MATCHES "WARNING|ERROR")
  file(REMOVE ${OUTPUT})
  message(FATAL_ERROR "${SOURCE} (${DEFINES}):\n${text}")
endif()
