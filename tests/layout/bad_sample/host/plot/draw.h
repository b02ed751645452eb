#pragma once
#include "collision/broad.h"
#include "host/error.h"
#include "host/io/csv.h"
