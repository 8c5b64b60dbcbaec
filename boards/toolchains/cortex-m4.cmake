# Single precision in hardware, double by software. QEMU's mps2-an386 is its board here.
set(core_flags "-mcpu=cortex-m4 -mfpu=fpv4-sp-d16")
set(COMPUEYE_MEMORY_MAP mps2-an386.ld)
set(COMPUEYE_CLOCK_HZ 25000000) # of SysTick on that board
set(COMPUEYE_CORE_OPTIMISATION -O3 -fno-schedule-insns) # or g++ hoists loads until registers overflow to the stack
include(${CMAKE_CURRENT_LIST_DIR}/cortex-m.cmake)
