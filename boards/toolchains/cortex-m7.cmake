# Single and double precision in hardware. QEMU's mps2-an500 is its board here.
set(core_flags "-mcpu=cortex-m7 -mfpu=fpv5-d16")
set(COMPUEYE_MEMORY_MAP mps2-an500.ld)
set(COMPUEYE_CLOCK_HZ 25000000) # of SysTick on that board
set(COMPUEYE_CORE_OPTIMISATION -O3 -fno-schedule-insns) # or g++ hoists loads until registers overflow to the stack
include(${CMAKE_CURRENT_LIST_DIR}/cortex-m.cmake)
