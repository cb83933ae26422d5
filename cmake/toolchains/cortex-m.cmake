# Common part of the Cortex-M toolchains. A file that includes this part sets cpu, fpu and board.
#
# Debian and Ubuntu: apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY) # a program cannot be linked without the code of a board
set(CMAKE_C_FLAGS_INIT
    "-mcpu=${cpu} -mthumb -mfloat-abi=hard -mfpu=${fpu} -ffunction-sections -fdata-sections")
# The emulated time advances by 8 ns per instruction, independent of the clock of the host.
set(CMAKE_CROSSCOMPILING_EMULATOR
    qemu-system-arm -M ${board} -display none -monitor none -serial none -icount shift=3,sleep=off
    -semihosting-config enable=on,target=native -kernel)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
