"""Study of paper 001 (Lemos 2019): walls of many patterns out of their plane, and a stone house."""
